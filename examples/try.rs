use flipmap::engine::*; use flipmap::engine::gpu::{GpuEngine,device::{self,Gpu}}; use flipmap::physics::*;
use std::time::Instant;
fn main(){
  let adapters=device::adapters(); for a in &adapters { println!("{}", device::describe(a)); }
  let t=Instant::now();
  let gpu=Gpu::open(adapters[0].clone()).unwrap(); println!("open {:?}", t.elapsed());
  let q=Question{pendulum:Pendulum::points([1.;2],[1.;2],9.81),rule:Rule::Second,budget_secs:30.};
  let r=Recipe{method:Method::LESSON,precision:Precision::F32};
  if std::env::args().nth(1).as_deref()==Some("text") { println!("{}", gpu::kernel::Design::general(&r,true,gpu.has_subgroups()).specialised(&q,&r).text()); return; }
  let t=Instant::now();
  let v=selfcheck::run(&gpu).unwrap(); for c in &v.checks { println!("{:?}", c); } println!("selfcheck {:?} {:?}", t.elapsed(), (v.f32,v.compensated,v.f64));
  let n=512usize; let ang=|i:usize| Dd::new((i as f64+0.5-256.0)*std::f64::consts::TAU/512.0);
  let pts:Vec<[Dd;2]>=(0..n*n).map(|k|[ang(k%n),-ang(k/n)]).filter(|a| !q.pendulum.forbids(Rule::Second,[a[0].hi,a[1].hi])).collect();
  let pts:Vec<[Dd;2]>=pts.iter().chain(&pts).chain(&pts).chain(&pts).copied().collect();
  for (prec,comp) in [(Precision::F32,true),(Precision::F32,false)] {
  let mut v=v.clone(); v.compensated=comp; v.f64=true; v.f32=true;
  let mut e=GpuEngine::new(Gpu::open(adapters[0].clone()).unwrap(), v);
  for rep in 0..3 {
  let t=Instant::now(); let mut rhs=0; let mut hist=[0;4];
  let mut chunks=pts.chunks(1<<16).enumerate(); let mut flying=0;
  loop { while flying<e.slots() { if let Some((i,c))=chunks.next(){ e.submit(Job{id:i as u64,question:q,recipe:Recipe{precision:prec,..r},starts:Starts::Rest(c.to_vec()),keep_unfinished:false}).unwrap(); flying+=1;} else {break;} }
    if flying==0 {break;}
    for f in e.poll(Wait::UntilFinished).unwrap(){ flying-=1; rhs+=f.rhs_evaluations; for o in f.outcomes { hist[o.status as usize]+=1; } } }
  println!("{prec} {comp} rep {rep}: {:?} {:.2} us/px rhs/px {} {:?}", t.elapsed(), t.elapsed().as_secs_f64()*1e6/pts.len() as f64, rhs/pts.len() as u64, hist);
  }}
}
