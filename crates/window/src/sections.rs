//! The sections of the side panel, and the panels in each.

/// A section of the side panel; the rail beside it has one icon for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// Where the view is, and where it could go.
    Explore,
    /// The pendulum, what is asked of it, and how exactly.
    Scene,
    /// The colours of the map, and what is drawn over it.
    Colours,
    /// Pictures and films as files.
    Film,
    /// The figures of the laboratory.
    Lab,
    /// The settings of the window.
    Settings,
}

/// A panel with a heading.
pub(crate) struct PanelEntry {
    /// The heading.
    pub name: &'static str,
    /// Other words, in lower case, for what is in the panel.
    pub also: &'static str,
    /// The section that holds the panel.
    pub section: Section,
}

impl Section {
    /// All sections, from the top of the rail down.
    pub(crate) const ALL: [Section; 6] = [
        Section::Explore,
        Section::Scene,
        Section::Colours,
        Section::Film,
        Section::Lab,
        Section::Settings,
    ];

    /// Returns the name, as the rail and the heading show it.
    pub fn name(self) -> &'static str {
        match self {
            Section::Explore => "Explore",
            Section::Scene => "Pendulum & question",
            Section::Colours => "Colours",
            Section::Film => "Picture & film",
            Section::Lab => "Laboratory",
            Section::Settings => "Settings",
        }
    }
}

const fn panel(name: &'static str, also: &'static str, section: Section) -> PanelEntry {
    PanelEntry { name, also, section }
}

/// All panels, in the order in which their sections show them.
pub(crate) const PANELS: [PanelEntry; 13] = [
    panel("Where you are", "minimap depth ruler last views", Section::Explore),
    panel("Find", "nearest filament island longest flip here", Section::Explore),
    panel("Deeper", "zoom descent dive filament", Section::Explore),
    panel("Places", "bookmarks scenes save this view", Section::Explore),
    panel("View", "centre width rotate stretch", Section::Explore),
    panel(
        "Scene",
        "question growth state first flips return chaos lyapunov mass length gravity friction \
         budget time plane section speeds rods points bob",
        Section::Scene,
    ),
    panel(
        "Accuracy",
        "engine method tolerance gpu cpu exact balanced fast precision check",
        Section::Scene,
    ),
    panel("Palette", "colours gradient relief times equalise cycles legend", Section::Colours),
    panel("Layers", "legend grid curve trust swing borders", Section::Colours),
    panel("Export", "save picture png screenshot image poster tiles", Section::Film),
    panel("Film", "video movie keyframes mp4 animation", Section::Film),
    panel("Figures", "laboratory lesson teach physics", Section::Lab),
    panel(
        "Window",
        "settings preferences theme cache edges anti-aliasing scale",
        Section::Settings,
    ),
];

/// Returns the section that holds the panel called `name`; the window's measurements, which have
/// no entry, are in the settings.
pub(crate) fn section_of(name: &str) -> Section {
    PANELS.iter().find(|panel| panel.name == name).map_or(Section::Settings, |panel| panel.section)
}
