use flipmap::engine::*; use flipmap::physics::*; use std::time::Instant;
fn main(){ let q=Question{pendulum:Pendulum::points([1.;2],[1.;2],9.81),rule:Rule::Second,budget_secs:30.};
  let n=512usize; let ang=|i:usize| Dd::new((i as f64+0.5-256.0)*std::f64::consts::TAU/512.0);
  let pts:Vec<[Dd;2]>=(0..n*n).map(|k|[ang(k%n),-ang(k/n)]).filter(|a| !q.pendulum.forbids(Rule::Second,[a[0].hi,a[1].hi])).collect();
  for prec in [Precision::F32,Precision::F64] { let mut e=cpu::CpuEngine::new(None).unwrap(); println!("{}",e.adapter());
  for rep in 0..3 { let t=Instant::now(); let r=Recipe{method:Method::LESSON,precision:prec};
   e.submit(Job{id:0,question:q,recipe:r,starts:Starts::Rest(pts.clone()),keep_unfinished:false}).unwrap();
   let f=e.poll(Wait::UntilFinished).unwrap().remove(0); let mut h=[0;4]; for o in &f.outcomes { h[o.status as usize]+=1; }
  println!("{prec} rep {rep}: {:?} {:.2} us/px rhs/px {} {:?}", t.elapsed(), t.elapsed().as_secs_f64()*1e6/pts.len() as f64, f.rhs_evaluations/pts.len() as u64, h); }}}
