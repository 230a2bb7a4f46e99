//! The project's rules that a machine can check: sizes of files, valid shaders, matching struct
//! counterparts, kernels with only the code that their scene needs.

use std::fs;
use std::mem::offset_of;
use std::path::{Path, PathBuf};

use crate::shader_structs::members;
use crate::sources::{product_files, rust_files};
use flipmap_engine::adapters::Pairs;
use flipmap_engine::gpu::kernel::{Design, selfcheck_text};
use flipmap_engine::gpu::shared::{
    CountedOutcome, JobHead, JobScene, Queue, RawOutcome, status_constants,
};
use flipmap_engine::level::{BALANCED, FAST, LESSON};
use flipmap_engine::pace::Pace;
use flipmap_engine::{EventSpec, IntegratorConfig, Method, Precision};
use flipmap_numbers::Decimal;
use flipmap_pendulum::Rule;
use flipmap_pendulum::extremum::Extremum;
use flipmap_render::output::sha256;
use flipmap_scene::question::Needs;
use flipmap_scene::{Kind, PendulumSpec};
use flipmap_shaders::{KEPT, KERNEL_PARTS, PICTURE};
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// The string literals of a file that spell an option such as `--width`.
fn options_in(text: &str) -> Vec<&str> {
    let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let spells = |line: &&str| {
        let option = |rest: &str| rest.starts_with(|letter: char| letter.is_ascii_lowercase());
        line.split("--").skip(1).any(option) && !line.contains("flipmap ")
    };
    lines.filter(spells).collect()
}

/// Outside the command line, errors call a setting by its name; `cli/exit.rs` calls it by its option.
#[test]
fn options_are_spelt_in_the_command_line_alone() {
    assert_eq!(
        options_in("\"--width is 0\"\n// --width\n\"flipmap run --shard 1\""),
        ["\"--width is 0\""]
    );
    for path in product_files() {
        if path.components().any(|part| part.as_os_str() == "cli") {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let found = options_in(&text);
        let found: Vec<_> =
            found.into_iter().filter(|line| !line.contains("--{setting}")).collect();
        assert!(found.is_empty(), "{}: {found:?}", path.display());
    }
}

#[test]
fn files_are_short() {
    let tests = ["tests", "crates/screen/src/tests"].map(Path::new).map(rust_files).concat();
    for file in product_files().into_iter().chain(tests) {
        let text = fs::read_to_string(&file).unwrap();
        let lines = text.split("#[cfg(test)]").next().unwrap_or(&text).lines().count();
        assert!(lines <= 400, "{} has {lines} lines before its tests", file.display());
    }
}

/// Paths of the pictures that a page shows, relative to the repository's root.
fn pictures_of(page: &Path) -> Vec<String> {
    let text = fs::read_to_string(page).unwrap();
    let folder = page.parent().unwrap();
    let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let is_picture =
        |link: &&str| [".png", ".webp", ".jpg"].iter().any(|ending| link.ends_with(ending));
    let pictures = links.filter(is_picture).filter(|link| !link.starts_with("http"));
    pictures.map(|link| folder.join(link).display().to_string()).collect()
}

#[test]
fn every_picture_of_the_pages_is_there_and_made_by_the_gallery() {
    let gallery = fs::read_to_string("scripts/gallery").unwrap();
    let made = |picture: &str| match picture.strip_prefix("docs/lab/") {
        Some(figure) => {
            let name = figure.trim_end_matches(".png");
            let figures =
                gallery.lines().find(|line| line.trim_start().starts_with("for name in "));
            figures.unwrap().split([' ', ';']).any(|word| word == name)
        }
        None => gallery.contains(picture),
    };
    let mut pages: Vec<PathBuf> = fs::read_dir("docs")
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "md"))
        .collect();
    pages.push("README.md".into());
    let pictures: Vec<String> = pages.iter().flat_map(|page| pictures_of(page)).collect();
    assert!(pictures.len() > 8, "{pictures:?}");
    for picture in pictures {
        assert!(Path::new(&picture).exists(), "{picture} is missing");
        // The contact sheet also shows rejected palettes, which no longer exist.
        let is_record = picture == "docs/palettes.jpg";
        assert!(made(&picture) || is_record, "{picture} is not made by scripts/gallery");
    }
    assert!(!made("docs/other.png") && !made("docs/lab/other.png"), "the test can fail");
}

fn question(build: PendulumSpec, rule: Rule, passes: u32) -> EventSpec {
    EventSpec { build, rule, budget_secs: 30.0, passes }
}

/// One design of every kind of kernel.
fn designs() -> Vec<Design> {
    let mut designs = Vec::new();
    let builds =
        [PendulumSpec::default(), PendulumSpec::new(Kind::Points, [1.0, 2.0], [1.0; 2], 9.81)];
    for (method, precision) in [
        (Method::LESSON, Precision::F32),
        (Method::LESSON, Precision::F64),
        (Method::dopri5(1e-7), Precision::F32),
        (Method::dopri5(1e-9), Precision::Df32),
        (Method::dop853(1e-12), Precision::F64),
        (Method::Taylor { tolerance: 1e-15 }, Precision::F64),
    ] {
        let config = IntegratorConfig { method, precision };
        for compensated in [false, true] {
            for subgroups in [false, true] {
                let general = Design::general(&config, compensated, subgroups).unwrap();
                designs.push(general);
                let rules = Rule::ALL.iter().map(|(_, rule)| *rule).chain([Rule::Neither]);
                let rules = rules.map(|rule| (rule, 1)).chain([(Rule::Second, 3)]);
                for (rule, passes) in rules.chain([(Rule::Either, u32::MAX)]) {
                    let made = |build| {
                        let question = question(build, rule, passes);
                        general.specialised(&question, &Pace::new(&question, &config).unwrap())
                    };
                    designs.extend(builds.map(made));
                    if rule == Rule::Neither && method.name() != "taylor" {
                        for ends in [Needs::Growth, Needs::Extremum(Extremum::NearestReturn)] {
                            designs.extend(builds.map(|build| made(build).computing(ends)));
                        }
                    }
                }
            }
        }
    }
    designs
}

fn parsed(text: &str) -> naga::Module {
    let module = naga::front::wgsl::parse_str(text);
    let module = module.unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
    let valid = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module);
    valid.unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
    module
}

#[test]
fn every_assembled_shader_is_valid() {
    let designs = designs();
    assert!(designs.len() > 50);
    for design in designs {
        let module = parsed(&design.text());
        let entries: Vec<&str> = module.entry_points.iter().map(|e| e.name.as_str()).collect();
        let begin: &[&str] = if design.begins() { &["begin"] } else { &[] };
        assert_eq!(entries, [&["advance", "look"], begin, &["turn"]].concat(), "{design:?}");
    }
    for precision in [Precision::F32, Precision::Df32, Precision::F64] {
        Pairs::ALL.iter().for_each(|&pairs| drop(parsed(&selfcheck_text(precision, pairs))));
    }
}

#[test]
fn structs_have_the_same_offsets_on_both_sides() {
    let method = Method::dopri5(1e-7);
    let config = IntegratorConfig { method, precision: Precision::F32 };
    let module = parsed(&Design::general(&config, true, true).unwrap().text());
    let head = size_of::<JobHead>();
    let job = [
        ("count", offset_of!(JobHead, count)),
        ("most_steps", offset_of!(JobHead, most_steps)),
        ("slice_steps", offset_of!(JobHead, slice_steps)),
        ("zero", offset_of!(JobHead, zero)),
        ("step", offset_of!(JobHead, step)),
        ("budget", offset_of!(JobHead, budget)),
        ("start", offset_of!(JobHead, start)),
        ("rise", offset_of!(JobHead, rise)),
        ("ceiling", offset_of!(JobHead, ceiling)),
        ("columns", offset_of!(JobHead, columns)),
        ("rows", offset_of!(JobHead, rows)),
        ("watched", head + offset_of!(JobScene, watched)),
        ("a", head + offset_of!(JobScene, a)),
        ("b", head + offset_of!(JobScene, b)),
        ("p", head + offset_of!(JobScene, p)),
        ("least_det", head + offset_of!(JobScene, least_det)),
        ("inverse_scale", head + offset_of!(JobScene, inverse_scale)),
    ];
    let outcome = [
        ("status", offset_of!(RawOutcome, status)),
        ("steps", offset_of!(RawOutcome, steps)),
        ("moment", offset_of!(RawOutcome, moment)),
        ("clearance", offset_of!(RawOutcome, clearance)),
    ];
    let mut counting = Design::general(&config, true, true).unwrap();
    counting.passes = 3;
    let counted = outcome.iter().copied().chain([
        ("unused", offset_of!(RawOutcome, turns)),
        ("passes", offset_of!(CountedOutcome, passes)),
    ]);
    let counted: Vec<_> = counted.map(|(name, offset)| (name.to_string(), offset)).collect();
    assert_eq!(members(&parsed(&counting.text()), "Outcome"), counted);
    let queue = [("turn", offset_of!(Queue, turn)), ("lengths", offset_of!(Queue, lengths))];
    for (name, counterpart) in [("Job", &job[..]), ("Outcome", &outcome[..]), ("Queue", &queue[..])]
    {
        let counterpart: Vec<_> =
            counterpart.iter().map(|(name, offset)| (name.to_string(), *offset)).collect();
        assert_eq!(members(&module, name), counterpart, "{name}");
    }
}

#[test]
fn no_shader_file_has_status_codes_of_its_own() {
    let names: Vec<String> = status_constants()
        .lines()
        .filter_map(|line| Some(line.split(':').next()?.to_string()))
        .collect();
    assert_eq!(names.len(), 5);
    let own = |text: &str| names.iter().any(|name| text.contains(name.as_str()));
    for (name, text) in KERNEL_PARTS.iter().chain(&[("picture", PICTURE), ("kept", KEPT)]) {
        assert!(!own(text), "{name}");
    }
    assert!(own("const ANSWERED: u32 = 1u;"), "the test can fail");
}

/// The lines of a shader that hold code, without their comments.
fn without_comments(text: &str) -> String {
    let code = text.lines().map(|line| line.split("//").next().unwrap_or_default().trim_end());
    code.filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n")
}

/// A new question, plane or force must not change the kernels of the home map, whose speeds
/// docs/reports records. If a change is intended, measure it and update the digests here.
#[test]
fn the_kernels_of_home_are_those_that_were_measured() {
    let home = question(PendulumSpec::default(), Rule::Second, 1);
    let digest = |config: IntegratorConfig, question: &EventSpec| {
        let pace = Pace::new(question, &config).unwrap();
        let design = Design::general(&config, true, true).unwrap().specialised(question, &pace);
        let text = design.text();
        sha256(without_comments(&text).as_bytes())[..16].to_string()
    };
    assert_eq!(
        [LESSON, FAST, BALANCED].map(|config| digest(config, &home)),
        ["1ed1d4f761b679c2", "93ee3e2385fdae04", "6cc0c97895c9d4d0"]
    );
    let friction = [0.1, 0.1].map(Decimal::from);
    let slowed = question(PendulumSpec { friction, ..PendulumSpec::default() }, Rule::Second, 1);
    assert_ne!(digest(BALANCED, &slowed), digest(BALANCED, &home), "the test can fail");
}

#[test]
fn the_home_kernel_holds_only_what_it_needs() {
    let config = IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };
    let home = question(PendulumSpec::default(), Rule::Second, 1);
    let pace = Pace::new(&home, &config).unwrap();
    let text = Design::general(&config, true, true).unwrap().specialised(&home, &pace).text();
    let text = without_comments(&text);
    // The kernel has no other rule, no pendulum data, and no general directions in the stages.
    for absent in
        ["watched", "job.a", "least_det", "now.t1, now.w1", "f64", "* 1.0f", " + 0.0f", "{%", "{{"]
    {
        assert!(!text.contains(absent), "{absent} is in the home kernel");
    }
    assert!(text.contains("now.t2, now.w2"));
    // No value in a step is computed twice or left unused.
    let step = text.split("fn step_from").nth(1).unwrap().split("\n}").next().unwrap();
    let values: Vec<&str> = step
        .lines()
        .filter_map(|line| line.trim().strip_prefix("let v"))
        .filter_map(|line| line.split(' ').next())
        .collect();
    assert!(values.len() > 100);
    for value in values {
        let uses = step
            .split(|c: char| !c.is_alphanumeric())
            .filter(|word| word[..].strip_prefix('v') == Some(value));
        assert!(uses.count() >= 2, "v{value} is never used");
    }
    let general = Design::general(&config, true, true).unwrap().text();
    assert!(general.contains("job.watched") && general.len() > text.len());
    // Two roundings per angle (its half turns, and their parity) and no more: the other stages
    // rotate the first direction instead.
    assert_eq!(step.matches("round(").count(), 4);
}
