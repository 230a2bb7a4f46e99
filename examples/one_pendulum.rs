//! Follows one pendulum with the gold standard, in f64 and in double-double.
//!
//! `cargo run --release --example one_pendulum`
use flipmap::{Dd, Outcome, Pendulum, Rule, Scalar, Status, oracle};

const BUDGET_SECS: f64 = 30.0;

/// Releases the pendulum at rest at (θ1, θ2) = (3, 3) rad, in numbers of type `T`.
fn release<T: Scalar>() -> Outcome<T> {
    let [one, three] = [1.0, 3.0].map(T::from_f64);
    let gravity = T::from_f64(9.81);
    let pendulum = Pendulum::points([one; 2], [one; 2], gravity);
    oracle::outcome(&pendulum, [three; 2], Rule::Second, T::from_f64(BUDGET_SECS))
}

fn main() {
    let (near, exact) = (release::<f64>(), release::<Dd>());
    match exact.status {
        Status::Answered => println!(
            "the second bob flips after {:.12} s; f64 errs by {:.0e} s",
            exact.time.to_f64(),
            (near.time - exact.time.to_f64()).abs()
        ),
        status => println!("no flip within {BUDGET_SECS} s: {status:?}"),
    }
}
