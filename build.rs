//! Lets tests declare, in the environment, that there is no graphics adapter or no display to open
//! windows on: they then show as ignored with that reason, instead of failing.

fn main() {
    for (variable, cfg) in [("FLIPMAP_NO_GPU", "no_gpu"), ("FLIPMAP_NO_WINDOW", "no_window")] {
        println!("cargo:rerun-if-env-changed={variable}");
        println!("cargo:rustc-check-cfg=cfg({cfg})");
        if std::env::var_os(variable).is_some_and(|value| value == "1") {
            println!("cargo:rustc-cfg={cfg}");
        }
    }
}
