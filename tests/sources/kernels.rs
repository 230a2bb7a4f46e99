//! Every kernel can be translated to the language of every kind of driver. If FLIPMAP_KERNELS names
//! a folder, all translations are written there for scripts/kernels.

use std::fs;
use std::mem::offset_of;
use std::path::Path;

use crate::shader_structs::members;
use flipmap_engine::adapters::Pairs;
use flipmap_engine::gpu::kernel::{Design, pack_text, selfcheck_text};
use flipmap_engine::gpu::packing::Packing;
use flipmap_engine::gpu::shared::{JobHead, NO_MOMENT, PackedWork, RawOutcome};
use flipmap_engine::pace::Pace;
use flipmap_engine::{EventSpec, IntegratorConfig, Method, Precision};
use flipmap_pendulum::Rule;
use flipmap_pendulum::extremum::Extremum;
use flipmap_scene::PendulumSpec;
use flipmap_scene::question::Needs;
use naga::back::{glsl, hlsl, msl, spv};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage};

/// Number types by name, with the method for pairs.
const NUMBERS: [(&str, Precision, Pairs); 6] = [
    ("f32", Precision::F32, Pairs::Fused),
    ("f64", Precision::F64, Pairs::Fused),
    ("df32", Precision::Df32, Pairs::Fused),
    ("df32_fenced", Precision::Df32, Pairs::Fenced),
    ("df32_results", Precision::Df32, Pairs::Results),
    ("df32_guarded", Precision::Df32, Pairs::Guarded),
];

/// Designs of every scheme for every kind of question, by name.
fn designs(subgroups: bool) -> Vec<(String, Design)> {
    let methods = ["rk4", "dopri5", "dop853", "taylor"];
    let all = methods.iter().flat_map(|method| NUMBERS.map(|number| (*method, number)));
    let mut designs = Vec::new();
    for (method, (number, precision, pairs)) in all {
        let config =
            IntegratorConfig { method: Method::named(method, precision).unwrap(), precision };
        // Pairs have no fixed steps, and expansions exist only in f64.
        let Ok(general) = Design::general(&config, true, subgroups) else { continue };
        let general = general.with_pairs(pairs);
        let made = |rule, passes| {
            let question =
                EventSpec { build: PendulumSpec::default(), rule, budget_secs: 30.0, passes };
            general.specialised(&question, &Pace::new(&question, &config).unwrap())
        };
        let questions = [
            ("general", general),
            ("second", made(Rule::Second, 1)),
            ("either", made(Rule::Either, 1)),
            ("passes", made(Rule::Second, 3)),
            ("turns", made(Rule::Neither, 1)),
            ("growth", made(Rule::Neither, 1).computing(Needs::Growth)),
            ("return", made(Rule::Neither, 1).computing(Needs::Extremum(Extremum::NearestReturn))),
        ];
        let name = |question| format!("{method}-{number}-{question}");
        // Expansions carry nothing along.
        let few = if method == "taylor" { &questions[..5] } else { &questions[..] };
        designs.extend(few.iter().map(|(question, design)| (name(question), *design)));
    }
    designs
}

/// A shader in several languages: file extension and content.
type Translations = Vec<(String, Vec<u8>)>;

/// Translates a kernel to the language of every kind of driver that has its number type; Metal has
/// no f64.
fn translations(text: &str, precision: Precision) -> Result<Translations, String> {
    let (module, info) = parsed(text)?;
    let mut all = vec![
        ("wgsl".to_string(), text.into()),
        ("spv".to_string(), spirv(&module, &info)?),
        ("hlsl".to_string(), hlsl(&module, &info)?.into()),
    ];
    if precision != Precision::F64 {
        all.push(("metal".to_string(), metal(&module, &info)?.into()));
    }
    for entry in &module.entry_points {
        all.push((format!("{}.glsl", entry.name), glsl(&module, &info, &entry.name)?.into()));
    }
    Ok(all)
}

fn parsed(text: &str) -> Result<(Module, ModuleInfo), String> {
    let module = naga::front::wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::all())
        .validate(&module)
        .map_err(|error| error.emit_to_string(text))?;
    Ok((module, info))
}

/// Index checks that wgpu adds if the driver itself checks the indices of buffers.
const BOUNDS: BoundsCheckPolicies = BoundsCheckPolicies {
    index: BoundsCheckPolicy::Restrict,
    buffer: BoundsCheckPolicy::Unchecked,
    image_load: BoundsCheckPolicy::Restrict,
    binding_array: BoundsCheckPolicy::Unchecked,
};

fn spirv(module: &Module, info: &ModuleInfo) -> Result<Vec<u8>, String> {
    let flags = spv::WriterFlags::empty();
    let lang_version = (1, 3);
    let options =
        spv::Options { lang_version, flags, bounds_check_policies: BOUNDS, ..Default::default() };
    let words = spv::write_vec(module, info, &options, None).map_err(|error| error.to_string())?;
    Ok(words.into_iter().flat_map(u32::to_le_bytes).collect())
}

/// Returns an error if an entry point of a translation has failed.
fn all_named<E: ToString>(names: Vec<Result<String, E>>) -> Result<(), String> {
    names.into_iter().try_for_each(|name| name.map(drop).map_err(|error| error.to_string()))
}

fn hlsl(module: &Module, info: &ModuleInfo) -> Result<String, String> {
    let options = hlsl::Options { shader_model: hlsl::ShaderModel::V6_0, ..Default::default() };
    let mut text = String::new();
    let written = hlsl::Writer::new(&mut text, &options, &hlsl::PipelineOptions::default())
        .write(module, info, None)
        .map_err(|error| error.to_string())?;
    all_named(written.entry_point_names)?;
    Ok(text)
}

fn metal(module: &Module, info: &ModuleInfo) -> Result<String, String> {
    let options =
        msl::Options { lang_version: (2, 4), bounds_check_policies: BOUNDS, ..Default::default() };
    let (text, written) =
        msl::write_string(module, info, &options, &msl::PipelineOptions::default())
            .map_err(|error| error.to_string())?;
    all_named(written.entry_point_names)?;
    Ok(text)
}

fn glsl(module: &Module, info: &ModuleInfo, entry: &str) -> Result<String, String> {
    let options = glsl::Options { version: glsl::Version::Desktop(450), ..Default::default() };
    let pipeline = glsl::PipelineOptions {
        shader_stage: ShaderStage::Compute,
        entry_point: entry.to_string(),
        multiview: None,
    };
    let mut text = String::new();
    glsl::Writer::new(&mut text, module, info, &options, &pipeline, BOUNDS)
        .and_then(|mut writer| writer.write())
        .map_err(|error| error.to_string())?;
    Ok(text)
}

/// Writes translations into the folder that FLIPMAP_KERNELS names, if it is set.
fn keep(name: &str, translations: &Translations) {
    let Some(folder) = std::env::var_os("FLIPMAP_KERNELS") else { return };
    for (ending, content) in translations {
        fs::write(Path::new(&folder).join(format!("{name}.{ending}")), content).unwrap();
    }
}

#[test]
fn every_kernel_is_translated_for_every_kind_of_driver() {
    let mut count = 0;
    for subgroups in [false, true] {
        for (name, design) in designs(subgroups) {
            let all = translations(&design.text(), design.precision)
                .unwrap_or_else(|error| panic!("{name}, subgroups {subgroups}: {error}"));
            assert!(all.iter().all(|(_, content)| content.len() > 100), "{name}");
            count += all.len();
            if subgroups {
                keep(&name, &all);
            }
        }
    }
    // WGSL, SPIR-V, HLSL and three entry points in GLSL; Metal's language without f64. Kernels that carry
    // nothing along have a fourth.
    let [questions, carrying, f32, f64, pairs] = [7, 2, 3, 3, 8];
    let fourths = (questions - carrying) * (f32 + f64 + pairs);
    let of_expansions = (questions - carrying) * 7;
    let all = questions * (7 * (f32 + pairs) + 6 * f64) + fourths + of_expansions;
    assert_eq!(count, 2 * all);
    for (number, precision, pairs) in NUMBERS {
        let all = translations(&selfcheck_text(precision, pairs), precision);
        keep(&format!("selfcheck-{number}"), &all.unwrap());
    }
    for packing in Packing::ALL {
        // Each of the languages, with one entry point in GLSL.
        let all = translations(&pack_text(packing), Precision::F32).unwrap();
        assert_eq!(all.len(), 5, "{packing:?}");
    }
}

#[test]
fn packed_outcomes_have_the_same_layout_on_both_sides() {
    for packing in Packing::ALL {
        let text = pack_text(packing);
        let (module, _) = parsed(&text).unwrap();
        let members = |name| members(&module, name);
        let named = |all: &[(&str, usize)]| -> Vec<(String, usize)> {
            all.iter().map(|(name, offset)| (name.to_string(), *offset)).collect()
        };
        assert_eq!(members("Head"), named(&[("count", offset_of!(JobHead, count))]));
        let sums = ("sums", offset_of!(PackedWork, sums));
        assert_eq!(members("Work"), named(&[sums, ("packed", offset_of!(PackedWork, packed))]));
        let outcome = [
            ("status", offset_of!(RawOutcome, status)),
            ("steps", offset_of!(RawOutcome, steps)),
            ("moment", offset_of!(RawOutcome, moment)),
            ("clearance", offset_of!(RawOutcome, clearance)),
        ];
        assert_eq!(members("Outcome"), named(&outcome));
        let no_moment = format!("const NO_MOMENT = {NO_MOMENT:#x}u;");
        assert!(text.contains(&no_moment), "{no_moment}");
        assert!(text.contains(&format!("const WORDS = {}u;", packing.words())));
    }
}

#[test]
fn a_kernel_that_no_driver_could_take_is_refused() {
    let (_, design) = &designs(true)[1];
    let text = design.text();
    assert!(translations(&text, design.precision).is_ok());
    // A number of the wrong type, an undefined function, and an entry point that only GLSL looks
    // up.
    for broken in [
        text.replacen("steps += select(0u, 1u, going)", "steps += select(0.0, 1.0, going)", 1),
        text.replacen("put_on(SUSPECTS", "put_off(SUSPECTS", 1),
    ] {
        assert_ne!(broken, text);
        assert!(translations(&broken, design.precision).is_err());
    }
    let (module, info) = parsed(&text).unwrap();
    assert!(glsl(&module, &info, "stand_still").is_err());
}
