//! A macro for tests that need a graphics adapter.

/// Declares tests that call the functions of a module and need a graphics adapter. If the adapter
/// is declared absent, they show as ignored.
macro_rules! needs_adapter {
    ($module:ident: $($name:ident)*) => {
        $(
            #[test]
            #[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
            fn $name() {
                $module::$name();
            }
        )*
    };
}
