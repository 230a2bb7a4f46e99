use flipmap::engine::*; use flipmap::engine::gpu::{GpuEngine,device::{self,Gpu}}; use flipmap::physics::*;
use std::time::Instant;
fn main(){ let a=device::adapters(); let gpu=Gpu::open(a[0].clone()).unwrap(); let v=selfcheck::run(&gpu).unwrap();
  let q=Question{pendulum:Pendulum::points([1.;2],[1.;2],9.81),rule:Rule::Second,budget_secs:30.};
  let r=Recipe{method:Method::LESSON,precision:Precision::F32};
  let mut e=GpuEngine::new(gpu,v);
  for n in [65536usize] { for _ in 0..2 { let t=Instant::now();
  e.submit(Job{id:0,question:q,recipe:r,starts:Starts::Rest(vec![[Dd::new(0.1),Dd::new(0.2)];n]),keep_unfinished:false}).unwrap();
  e.poll(Wait::UntilFinished).unwrap(); println!("{n}: {:?} per slice {:?}", t.elapsed(), t.elapsed()/3600); } } }
