//! `flipmap trace`: follows one pendulum, at rest or thrown, with the gold standard in double-double.

use std::io::Write;
use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use flipmap::output::{Destination, SafeFile};
use flipmap::physics::opening::settled;
use flipmap::physics::taylor::{Orbit, TaylorStep};
use flipmap::physics::{Dd, Launch, Pendulum, Scalar, State, oracle};
use flipmap::scene::in_rad;

use super::exit::Exit;
use super::options::SceneOptions;
use super::same_file::keep_apart;
use super::stop;
use super::trace_columns::{Pass, QuestionColumns};

#[derive(Args, Debug)]
pub(super) struct Options {
    /// Angles in rad at which the pendulum is released from rest, with any number of digits, or as
    /// in -95deg,0.5pi; or these and the speeds in rad/s with which it is thrown
    #[arg(long, value_name = "θ1,θ2[,ω1,ω2]", allow_hyphen_values = true)]
    start: String,
    /// Simulated seconds to trace
    #[arg(long, value_name = "SECONDS", default_value = "30", allow_hyphen_values = true)]
    until: String,
    /// Simulated seconds between rows
    #[arg(long, value_name = "SECONDS", default_value = "0.01", allow_hyphen_values = true)]
    every: String,
    /// Table to write (default: standard output)
    #[arg(short, long, value_name = "FILE.csv")]
    output: Option<PathBuf>,
    /// Print the flips as one JSON object on standard output; requires -o
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    scene: SceneOptions,
}

pub(super) fn run(options: &Options) -> anyhow::Result<()> {
    let scene = options.scene.document()?.scene();
    let output = options.output.as_deref().map(|path| ("-o", path));
    keep_apart(options.scene.file().as_slice(), output.as_slice())?;
    let pendulum: Pendulum<Dd> = scene.build.pendulum_in();
    let Launch { angle, speed } = parse_start(&options.start)?;
    let until = seconds("--until", &options.until, 1e-9..=1e6)?;
    let every = seconds("--every", &options.every, 1e-9..=1e6)?;
    if (until / every).hi > MOST_ROWS {
        let message = format!(
            "--every {} gives {:.0e} rows in {} s; at most {MOST_ROWS:e} are allowed",
            options.every,
            (until / every).hi,
            options.until
        );
        return Err(Exit::Usage(message).into());
    }
    let to_stdout = options.output.as_ref().is_none_or(|path| path.as_os_str() == "-");
    if options.json && to_stdout {
        return Err(
            Exit::Usage("--json needs -o FILE.csv: both would use standard output".into()).into()
        );
    }
    let destination = Destination::from(options.output.as_deref().unwrap_or("-".as_ref()));
    let mut out = match &options.output {
        Some(_) => SafeFile::create(&destination)
            .with_context(|| format!("-o: cannot write {destination}"))?,
        None => SafeFile::Stdout(std::io::BufWriter::new(std::io::stdout())),
    };
    stop::listen()?;
    let at_rest = speed == [Dd::new(0.0); 2];
    let angle = if at_rest { settled(&pendulum, angle) } else { angle };
    let start = State { angle, speed };
    let columns = QuestionColumns::new(&scene, &start);
    let flips = follow(&pendulum, start, columns, [until, every], &mut out).map_err(|error| {
        match error.is::<std::io::Error>() {
            true => error.context(format!("cannot write {destination}")),
            false => error,
        }
    })?;
    out.finish().with_context(|| format!("cannot write {destination}"))?;
    tell(options, &flips)
}

/// Maximum number of rows that a table may reasonably have.
const MOST_ROWS: f64 = 1e8;

/// Writes the rows and returns all crossings of the top in order of time.
fn follow(
    pendulum: &Pendulum<Dd>,
    start: State<Dd>,
    mut columns: QuestionColumns,
    [until, every]: [Dd; 2],
    out: &mut SafeFile,
) -> anyhow::Result<Vec<Pass>> {
    writeln!(out, "t,theta1,theta2,omega1,omega2,energy_error{}", columns.head())?;
    let energy = pendulum.energy(&start);
    let scale = pendulum.p + pendulum.q;
    let mut orbit = Orbit::new(*pendulum, start);
    let (mut passages, mut row) = (Vec::new(), 0u64);
    while orbit.time() < until {
        stop::check()?;
        let step = orbit.step();
        anyhow::ensure!(orbit.state().speed[1].is_finite(), "the motion is no longer finite");
        let first = passages.len();
        passages.extend(passages_in(&step).into_iter().filter(|p| p.time <= until));
        columns.add(&passages[first..]);
        loop {
            let time = every * Dd::new(row as f64);
            if time > step.end() || time > until {
                break;
            }
            stop::check()?;
            let state = step.state(time - step.start);
            let rise = pendulum.energy(&state) - energy;
            let error = if scale.hi > 0.0 { (rise / scale).hi } else { 0.0 };
            write_row(out, time, &state, error, &columns.row(time, &state))?;
            row += 1;
        }
    }
    Ok(passages)
}

fn write_row(
    out: &mut SafeFile,
    time: Dd,
    state: &State<Dd>,
    error: f64,
    more: &str,
) -> std::io::Result<()> {
    let [theta1, theta2] = state.angle.map(|x| x.hi);
    let [omega1, omega2] = state.speed.map(|x| x.hi);
    writeln!(out, "{},{theta1},{theta2},{omega1},{omega2},{error:e}{more}", time.hi)
}

fn passages_in(step: &TaylorStep<Dd>) -> Vec<Pass> {
    let mut passages: Vec<Pass> = (0..2)
        .flat_map(|bob| {
            oracle::passages(&step.angle[bob], step.length).into_iter().map(move |tau| (bob, tau))
        })
        .map(|(bob, tau)| Pass {
            bob: bob + 1,
            time: step.start + tau,
            anticlockwise: step.state(tau).speed[bob].hi > 0.0,
        })
        .collect();
    passages.sort_by(|a, b| a.time.hi.total_cmp(&b.time.hi));
    passages
}

/// Prints the crossings; the first of each bob is its flip.
fn tell(options: &Options, passages: &[Pass]) -> anyhow::Result<()> {
    let first = |bob| passages.iter().find(|p| p.bob == bob).map(|p| p.time.hi);
    if options.json {
        let list: Vec<_> = passages
            .iter()
            .map(|p| serde_json::json!({ "bob": p.bob, "time": p.time.hi }))
            .collect();
        let object = serde_json::json!({
            "first_flip": first(1), "second_flip": first(2), "passages": list,
        });
        return super::say(&serde_json::to_string_pretty(&object)?);
    }
    for (bob, name) in [(1, "first"), (2, "second")] {
        match passages.iter().find(|p| p.bob == bob) {
            Some(flip) => super::tell(&format!("flipmap: the {name} bob flips at {} s", flip.time)),
            None => super::tell(&format!("flipmap: the {name} bob does not flip")),
        }
    }
    for Pass { bob, time, .. } in passages {
        super::tell(&format!("flipmap: bob {bob} passes the top at {:.12} s", time.hi));
    }
    Ok(())
}

fn parse_start(text: &str) -> Result<Launch, Exit> {
    let numbers: Option<Vec<Dd>> = text.split(',').map(|part| Dd::parse(&in_rad(part))).collect();
    let numbers = numbers.filter(|all| all.iter().all(|number| number.hi.abs() <= 1e6));
    let (angle, speed) = match numbers.as_deref() {
        Some(&[theta1, theta2]) => ([theta1, theta2], [Dd::new(0.0); 2]),
        Some(&[theta1, theta2, omega1, omega2]) => ([theta1, theta2], [omega1, omega2]),
        _ => {
            return Err(Exit::Usage(format!(
                "--start is '{text}'; it must be two angles between -1e6 and 1e6 rad, separated by \
                 a comma, or these and two speeds between -1e6 and 1e6 rad/s"
            )));
        }
    };
    let near = |theta: Dd| if theta.abs() <= Dd::PI { theta } else { theta.wrapped() };
    Ok(Launch { angle: angle.map(near), speed })
}

fn seconds(option: &str, text: &str, range: std::ops::RangeInclusive<f64>) -> Result<Dd, Exit> {
    Dd::parse(text).filter(|time| range.contains(&time.hi)).ok_or_else(|| {
        Exit::Usage(format!(
            "{option} is '{text}'; it must be a number of seconds between {:e} and {:e}",
            range.start(),
            range.end()
        ))
    })
}
