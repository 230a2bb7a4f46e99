//! Lets tests declare, in the environment, that there is no graphics adapter: they then show as
//! ignored with that reason, instead of failing.

fn main() {
    println!("cargo:rerun-if-env-changed=FLIPMAP_NO_GPU");
    println!("cargo:rustc-check-cfg=cfg(no_gpu)");
    if std::env::var_os("FLIPMAP_NO_GPU").is_some_and(|value| value == "1") {
        println!("cargo:rustc-cfg=no_gpu");
    }
}
