//! Examples at the end of `--help`: commands that a person would try.

/// The examples of `flipmap --help`.
pub(super) const FLIPMAP: &str = "Examples:
  flipmap                              explore the map in a window
  flipmap render filigree              a picture of a built-in scene, filigree.png
  flipmap explore filigree.png         open the view of a picture in the window
  flipmap help render                  all options for pictures

Before the first picture, flipmap measures the engines for a few seconds.";

/// The examples of `flipmap render --help`.
pub(super) const RENDER: &str = "Examples:
  flipmap render threads --size 4k -o threads.png
  flipmap render --center=-95deg,0.5pi --width 0.1 --accuracy exact -o here.png --trust sure.png
  flipmap render --ask state --at 12 --legend -o state.png
  flipmap render --masses 1,3 --lengths 1,0.5 -o heavy.png --raw heavy.npy";

/// The examples of `flipmap video --help`.
pub(super) const VIDEO: &str = "Examples:
  flipmap video --zoom-to deep --secs 20 --size 1080p -o zoom.mp4
  flipmap video --vary gravity=9.81..1.62 --size 640x360 -o moon.gif
  flipmap video moment --vary at=0..12 -o moment.webp";

/// The examples of `flipmap measure --help`.
pub(super) const MEASURE: &str = "Examples:
  flipmap measure --of areas,survival
  flipmap measure rods --samples 1000000 -o rods/
  flipmap measure --ask first --of wada,entropy -o basins/ --json";

/// The examples of `flipmap trace --help`.
pub(super) const TRACE: &str = "Examples:
  flipmap trace --start=170deg,-0.5pi --until 10 -o path.csv
  flipmap trace rods --start=2,1 --json -o path.csv";
