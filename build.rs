//! Lets tests declare, in the environment, that there is no graphics adapter, no display to open
//! windows on, or no ffmpeg: they then show as ignored with that reason, instead of failing. Job
//! engines and clean roots are the other way round, for few machines have them.

fn main() {
    for (variable, cfg) in [
        ("FLIPMAP_NO_GPU", "no_gpu"),
        ("FLIPMAP_NO_WINDOW", "no_window"),
        ("FLIPMAP_NO_FFMPEG", "no_ffmpeg"),
        ("FLIPMAP_FARM", "farm"),
        ("FLIPMAP_PACKAGE", "package"),
    ] {
        println!("cargo:rerun-if-env-changed={variable}");
        println!("cargo:rustc-check-cfg=cfg({cfg})");
        if std::env::var_os(variable).is_some_and(|value| value == "1") {
            println!("cargo:rustc-cfg={cfg}");
        }
    }
}
