//! scratch
use flipmap::engine::{*, cpu::CpuEngine, depth::DepthEngine, level::*};
use flipmap::physics::*;
use flipmap::scene::*;
use flipmap::tiles::*;
use std::time::Instant;
fn samples(scene: &Scene, n: u32, recipe: Recipe, engine: &mut dyn Engine) -> (Vec<Outcome>, Counts) {
    let mut work = Work::new(scene, [n, n], recipe, 4096);
    let mut out = vec![Outcome::without_time(Status::Unflipped); (n*n) as usize];
    loop { let f = work.work(engine, None).unwrap(); if f.is_empty() {break;}
        for t in f { for ([x,y],o) in t.tile.pixels().zip(t.samples.iter()) { out[(y*n+x) as usize]=o; } } }
    (out, work.counts())
}
fn scene(c: &[Theta;2], w: f64, budget: f64) -> Scene {
    let mut s = Scene::default();
    s.view = View { center: c.map(|t| t.to_string()), width: format!("{w:e}"), ..View::default() };
    s.question.budget = budget; s
}
fn budget(w: f64) -> f64 { 30f64.max(-10.0/3.0*w.log10()) }
fn truth(s: &Scene, n: u32, only: &[usize]) -> Vec<Outcome> {
    let c = s.view.center_rad(); let w: f64 = s.view.width.parse().unwrap();
    let pen: Pendulum<Fixed<4>> = s.build.pendulum().convert();
    let one = |k: usize| { let (i,j)=(k as u32%n,k as u32/n);
        let x=(i as f64+0.5-n as f64/2.0)*w/n as f64; let y=(n as f64/2.0-j as f64-0.5)*w/n as f64;
        let a=[(c[0]+Theta::from_f64(x)).resized::<4>(),(c[1]+Theta::from_f64(y)).resized::<4>()];
        let o=gold::outcome(&pen,a,s.question.rule,Fixed::from_f64(s.question.budget)); Outcome{status:o.status,time:o.time.to_f64()} };
    let h=only.len()/2;
    std::thread::scope(|sc| { let a=sc.spawn(|| only[..h].iter().map(|k| one(*k)).collect::<Vec<_>>()); let b:Vec<_>=only[h..].iter().map(|k| one(*k)).collect(); let mut a=a.join().unwrap(); a.extend(b); a })
}
fn right(a:&Outcome,b:&Outcome)->bool{ a.status==b.status && (a.status!=Status::Flipped || (a.time-b.time).abs()<=1e-3) }
fn main(){
    let every: usize = std::env::args().nth(1).map_or(7,|a|a.parse().unwrap());
    let last: f64 = std::env::args().nth(2).map_or(1e-22,|a|a.parse().unwrap());
    let mut e = DepthEngine::new(Box::new(CpuEngine::new(None).unwrap()), None).unwrap();
    let mut c=["0.01","0.02"].map(|t| Theta::parse(t).unwrap()); let mut w=6f64;
    let n=24;
    let mut next=1e-3;
    while w>last*0.99 {
        let pf=format!("/tmp/x/path-{w:.3e}.txt");
        if let Ok(t)=std::fs::read_to_string(&pf) { let v:Vec<&str>=t.split_whitespace().collect(); c=[Theta::parse(v[0]).unwrap(),Theta::parse(v[1]).unwrap()]; } else { std::fs::write(&pf,format!("{} {}",c[0],c[1])).unwrap(); }
        let s=scene(&c,w,budget(w));
        let (o,_)=samples(&s,n,BALANCED,&mut e);
        // most structure
        let t=|i:i32,j:i32| { let p=&o[(j*n as i32+i) as usize]; if p.status==Status::Flipped{p.time}else{s.question.budget} };
        let mut best=(-1.0,0,0);
        for j in 2..n as i32-2 { for i in 2..n as i32-2 { let mut sc=0.0; for dj in -2..=2 { for di in -2..=2 { let (a,b)=(t(i+di,j+dj),t(i,j)); if a.min(b)>0.4*s.question.budget && a.max(b)<s.question.budget { sc+=(a-b).abs().min(1.0); }} } if sc>best.0 {best=(sc,i,j);} } }
        if w<=next*1.01 {
            let only:Vec<usize>=(0..(n*n) as usize).step_by(every).collect();
            let t0=Instant::now(); let file=format!("/tmp/x/truth-{w:.0e}-{every}.txt");
            let tr:Vec<Outcome>=match std::fs::read_to_string(&file) { Ok(t)=>t.lines().map(|l| if l=="u" {Outcome::without_time(Status::Unflipped)} else {Outcome::flipped(l.parse().unwrap())}).collect(), Err(_)=>{ let tr=truth(&s,n,&only); std::fs::write(&file,tr.iter().map(|o| if o.status==Status::Flipped {format!("{:?}\n",o.time)} else {"u\n".to_string()}).collect::<String>()).unwrap(); tr}}; let tt=t0.elapsed().as_secs_f64();
            let flipped=tr.iter().filter(|o|o.status==Status::Flipped).count();
            let (lo,hi)=tr.iter().filter(|o|o.status==Status::Flipped).fold((1e9f64,0f64),|(a,b),o|(a.min(o.time),b.max(o.time)));
            print!("w {w:.0e} flips {flipped}/{} {lo:.1}-{hi:.1} truth {tt:.0}s |",only.len());
            for r in [BALANCED,FAST] { let mut e = DepthEngine::new(Box::new(CpuEngine::new(None).unwrap()), None).unwrap(); let t0=Instant::now(); let (o,cnt)=samples(&s,n,r,&mut e); let dt=t0.elapsed().as_secs_f64();
              let good=only.iter().zip(&tr).filter(|(k,t)| right(&o[**k],t)).count();
              print!(" {} {:.3} ({dt:.2}s rhs/px {})",r.precision,good as f64/only.len() as f64,cnt.rhs_evaluations/cnt.simulated.max(1)); }
            println!(); next=w/1000.0*1.001;
        }
        let d=w/n as f64;
        c=[c[0]+Theta::from_f64((best.1 as f64+0.5-n as f64/2.0)*d), c[1]+Theta::from_f64((n as f64/2.0-best.2 as f64-0.5)*d)];
        w/=10f64.sqrt();
    }
    println!("{} {}", c[0].decimal(60), c[1].decimal(60));
}
