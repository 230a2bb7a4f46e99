use flipmap::physics::*; use std::time::Instant;
fn main(){ let p=Pendulum::points([1.;2],[1.;2],9.81f64); let h=1.0/120.0;
 for _ in 0..2 { let t=Instant::now(); let mut n=0; let mut steps=0u64; let mut acc=0.;
 for k in 0..512*512 { if k%97!=0 {continue;} let a=[(k%512),(k/512)].map(|i| (i as f64+0.5-256.)*std::f64::consts::TAU/512.);
  if p.forbids(Rule::Second,a){continue;} n+=1; let mut s=State::rest(a); for _ in 0..3600 { steps+=1; s=s.plus(&integrator::rk4(&p,&s,h,trig::Turning::Fresh)); if s.angle[1].abs()>=std::f64::consts::PI {break;} } acc+=s.angle[0]; }
 println!("scalar {:.1} us/px, {:.1} ns/step {acc}", t.elapsed().as_secs_f64()*1e6/n as f64, t.elapsed().as_secs_f64()*1e9/steps as f64); } }
