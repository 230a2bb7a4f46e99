//! `flipmap doctor`: shows the adapters, which of them can be trusted, and what would be used.

use std::fmt::Write as _;

use clap::Args;
use flipmap_engine::adapters::{Adapter, AdapterFinding, INSTALL_HINT, Verdict};
use flipmap_engine::choice::{EngineRequest, choose};
use flipmap_engine::profile::{Profile, TimedPairs};
use serde_json::{Value, json};

#[derive(Args, Debug)]
pub(super) struct Options {
    /// Measure every engine at every accuracy level, and save the profile
    #[arg(long)]
    profile: bool,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

pub(super) fn run(options: &Options) -> anyhow::Result<()> {
    let findings: Vec<AdapterFinding> = Adapter::all().iter().map(Adapter::finding).collect();
    if options.profile {
        let profile = Profile::measure(None, TimedPairs::OnHardware);
        if let Err(error) = profile.keep() {
            super::tell(&format!("flipmap: the profile could not be saved: {error}"));
        }
    }
    let tell = |text: &str| super::tell(&format!("flipmap: {text}"));
    let profile = Profile::get(None, &tell);
    let chosen = choose(&EngineRequest::default(), &tell)?;
    let used = format!("{} ({})", chosen.engine.kind(), chosen.engine.adapter());
    if options.json {
        let object = json!({
            "adapters": findings.iter().map(as_json).collect::<Vec<_>>(),
            "engine": chosen.engine.kind(),
            "adapter": chosen.engine.adapter(),
            "why": chosen.why,
            "profile": profile,
        });
        return super::say(&serde_json::to_string_pretty(&object)?);
    }
    let mut text = String::new();
    if findings.is_empty() {
        writeln!(text, "Adapters: none. {INSTALL_HINT}")?;
    }
    for finding in &findings {
        describe_finding(&mut text, finding)?;
    }
    describe_profile(&mut text, &profile)?;
    write!(text, "\nWould use: {used}\n  because {}", chosen.why)?;
    super::say(&text)
}

fn describe_finding(text: &mut String, finding: &AdapterFinding) -> anyhow::Result<()> {
    let has = |feature| if feature { "yes" } else { "no" };
    writeln!(text, "Adapter: {}", finding.name)?;
    writeln!(
        text,
        "  features: f64 {}, subgroups {}, timestamps {}",
        has(finding.has_f64),
        has(finding.has_subgroups),
        has(finding.has_timestamps),
    )?;
    writeln!(
        text,
        "  limits: buffers of {} MiB, storage bindings of {} MiB, {} workgroups per dispatch",
        finding.max_buffer_bytes >> 20,
        finding.max_binding_bytes >> 20,
        finding.max_workgroups,
    )?;
    match &finding.verdict {
        Err(error) => writeln!(text, "  cannot be used: {error}")?,
        Ok(verdict) => {
            writeln!(text, "  self-check:")?;
            for check in &verdict.checks {
                let mark = if check.passed { "passed" } else { "FAILED" };
                writeln!(text, "    {mark} {} {}: {}", check.precision, check.name, check.detail)?;
            }
            let word = |offered| if offered { "offered" } else { "not offered" };
            let kept = if verdict.compensated { "with" } else { "without" };
            writeln!(
                text,
                "  precisions: f32 {} ({kept} compensated states), df32 {} (by {}), f64 {}",
                word(verdict.f32),
                word(verdict.df32),
                verdict.pairs.name(),
                word(verdict.f64)
            )?;
        }
    }
    Ok(())
}

/// Writes the performance of each engine at each accuracy level.
fn describe_profile(text: &mut String, profile: &Profile) -> anyhow::Result<()> {
    writeln!(text, "\nProfile (flipmap doctor --profile measures it again):")?;
    writeln!(text, "  level     method  setting           precision  µs/pixel  right  engine")?;
    for row in &profile.rows {
        writeln!(
            text,
            "  {:9} {:7} {:17} {:9} {:9.2} {:6.3}  {} {}",
            row.accuracy.to_string(),
            row.method,
            row.setting,
            row.precision,
            row.us_per_pixel,
            row.right,
            row.engine,
            row.adapter
        )?;
    }
    for refused in &profile.refused {
        writeln!(text, "  not offered: {refused}")?;
    }
    Ok(())
}

fn as_json(finding: &AdapterFinding) -> Value {
    let checks = |verdict: &Verdict| -> Vec<Value> {
        verdict
            .checks
            .iter()
            .map(|check| {
                json!({
                    "precision": check.precision.to_string(),
                    "name": check.name,
                    "passed": check.passed,
                    "detail": check.detail,
                })
            })
            .collect()
    };
    json!({
        "name": finding.name,
        "f64": finding.has_f64,
        "max_buffer_size": finding.max_buffer_bytes,
        "max_storage_buffer_binding_size": finding.max_binding_bytes,
        "checks": finding.verdict.as_ref().map(checks).unwrap_or_default(),
        "offered": finding.verdict.as_ref().map(|v| json!({"f32": v.f32, "df32": v.df32, "f64": v.f64})).ok(),
        "error": finding.verdict.as_ref().err(),
    })
}
