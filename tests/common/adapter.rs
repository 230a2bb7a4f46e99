//! Which tests need a graphics adapter.

/// Tests of the functions of a module that need a graphics adapter: where one is declared absent
/// they show as ignored.
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
