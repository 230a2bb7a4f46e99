//! What a page is told of its map, as JSON.

use flipmap_engine::adapters::Check;
use flipmap_scene::palette::{AnswerColours, Palette, Rgb};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{BUILT_IN, Scene, Setting, location};
use serde_json::{Value, json};

use crate::map::Map;

/// Questions that a page offers: those whose kernels compile fast enough in a browser.
const QUESTIONS: [QuestionName; 4] =
    [QuestionName::Flip, QuestionName::First, QuestionName::State, QuestionName::Growth];
/// Number of colours along a legend's bar.
const BAR: usize = 64;

fn css([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

impl Map {
    /// The state of the map.
    pub(crate) fn told(&self) -> Value {
        let progress = self.explorer.progress();
        let scene = self.shown();
        let (location, least_rad) = (location::text(&scene), self.least_width_rad());
        let text = |setting: Setting| setting.text(&scene);
        let checked = |check: &Check| json!({ "name": check.name, "passed": check.passed, "detail": check.detail });
        json!({
            "level": if self.is_balanced() { "balanced" } else { "fast" },
            "share": progress.share,
            "way": progress.way,
            "covered": progress.covered,
            "adapter": self.adapter(),
            "is_software": self.is_software(),
            "width": self.camera.width(),
            "unit": scene.plane.axes()[0].unit(),
            "least_width": least_rad * self.camera.reach.units(),
            "at_end": self.camera.width_rad <= least_rad * 1.000_001,
            "command": format!("flipmap explore '{location}'"),
            "checks": self.checks.iter().map(checked).collect::<Vec<_>>(),
            "settings": {
                "ask": text(Setting::Ask),
                "rule": text(Setting::Rule),
                "budget": text(Setting::Budget),
                "masses": text(Setting::Masses),
                "lengths": text(Setting::Lengths),
                "gravity": text(Setting::Gravity),
            },
            "auto_budget": scene.question.budget.auto,
            "budget_secs": scene.question.budget.secs,
            "picture": {
                "palette": self.picture.palette,
                "relief": self.picture.relief,
                "scale": self.picture.scale,
                "reverse": self.picture.reverse,
                "cycles": self.picture.cycles,
            },
        })
    }

    /// The legend of the colours.
    pub(crate) fn legend(&self) -> Result<Value, String> {
        let colours = AnswerColours::new(&self.scene, &self.picture);
        let colours = colours.map_err(|error| error.to_string())?;
        let title = colours.title(self.scene.question.ask);
        let along = |k: usize| css(colours.colour_along(k as f64 / (BAR - 1) as f64));
        let labels = colours.bar_labels();
        let tick = |(place, label): &(u16, String)| json!({ "place": f64::from(*place) / 1000.0, "label": label });
        let steps = colours.step_labels(34.0);
        let step = |(place, label): &(f64, String)| json!({ "place": place, "label": label });
        let ticks: Vec<Value> = match &steps {
            Some(steps) => steps.iter().map(step).collect(),
            None => labels.ticks.iter().map(tick).collect(),
        };
        let ground = colours.ground();
        Ok(json!({
            "name": title.name,
            "unit": title.unit,
            "from": labels.from,
            "square": colours.is_square(),
            "colours": (0..BAR).map(along).collect::<Vec<_>>(),
            "ticks": ticks,
            "unflipped": css(ground.unflipped),
            "forbidden": css(ground.forbidden),
        }))
    }
}

/// What there is to choose from.
pub(crate) fn choices() -> Value {
    let question = |ask: &QuestionName| {
        let kind = ask.kind();
        json!({ "name": kind.name, "sentence": kind.asks })
    };
    let scenes = BUILT_IN.iter().filter_map(|built_in| {
        let document = built_in.document();
        let scene: Scene = document.scene();
        let is_offered = QUESTIONS.contains(&scene.question.ask);
        is_offered.then(|| {
            json!({
                "name": built_in.name,
                "sentence": built_in.sentence(),
                "link": location::text(&scene),
            })
        })
    });
    json!({
        "palettes": Palette::names().collect::<Vec<_>>(),
        "questions": QUESTIONS.iter().map(question).collect::<Vec<_>>(),
        "scenes": scenes.collect::<Vec<_>>(),
    })
}
