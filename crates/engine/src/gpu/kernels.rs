//! The kernels that an engine keeps, and the thread that compiles more of them in the background.
//!
//! For a window, a new scene is answered at once by the general kernel, which reads the scene as
//! data. The scene's own kernel is compiled once the scene has rested, so that a slider in motion
//! compiles nothing. The two kernels round differently, so a picture is computed by the kernel it
//! began with.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use super::device::Gpu;
use super::kernel::Design;
use super::pipeline::Kernel;
use super::waiting::now;
use crate::EngineError;
use crate::clock::Instant;

/// Largest number of kernels that an engine keeps. A picture needs one, its checks and the other
/// questions of a scene a few more; dropping one costs only the time to compile it again.
pub const MAX_KERNELS: usize = 24;
/// Time for which a scene has to stay the same before a kernel is compiled for it.
const REST: Duration = Duration::from_millis(300);

/// The kernels of one device, and the choice between them for the present picture.
#[derive(Default)]
pub(super) struct Kernels {
    kept: RecentlyUsed<Kernel>,
    /// Pairs of a design made for a scene and the design that computes the scene in the present
    /// picture.
    choices: Vec<(Design, Design)>,
    compiler: Option<KernelCompiler>,
    compile_secs: f64,
}

impl Kernels {
    /// The kernel of a design; compiles it if it is not kept.
    pub(super) fn get(
        &mut self,
        gpu: &Gpu,
        design: Design,
        workgroup: u32,
    ) -> Result<Arc<Kernel>, EngineError> {
        self.collect();
        if let Some(kernel) = self.kept.get(|kernel| kernel.design == design) {
            return Ok(kernel);
        }
        let begun = Instant::now();
        let kernel = Kernel::new(gpu, design, workgroup)?;
        self.compile_secs += begun.elapsed().as_secs_f64();
        Ok(self.kept.add(kernel))
    }

    /// Returns true if a design is compiled.
    pub(super) fn has(&mut self, design: &Design) -> bool {
        self.collect();
        self.kept.has(|kernel| kernel.design == *design)
    }

    /// Begins another picture, for which every choice is open again.
    pub(super) fn begin_picture(&mut self) {
        self.choices.clear();
    }

    /// Returns the design with which the present picture began a scene, or `None` before its first
    /// job.
    pub(super) fn chosen(&self, special: &Design) -> Option<Design> {
        let chosen = self.choices.iter().find(|(asked, _)| asked == special);
        chosen.map(|(_, chosen)| *chosen)
    }

    /// Fixes the design that computes a scene until the next picture.
    pub(super) fn choose(&mut self, special: Design, chosen: Design) {
        if self.chosen(&special).is_none() {
            self.choices.push((special, chosen));
        }
    }

    /// Requests that a design be compiled in the background, unless it is compiled or was the last
    /// to be requested.
    pub(super) fn wish(&mut self, gpu: &Gpu, design: Design, workgroup: u32, haste: CompileWhen) {
        if self.has(&design) {
            return;
        }
        // Without a thread the general kernel stays in use.
        let compiler = self.compiler.get_or_insert_with(|| KernelCompiler::new(&gpu.device));
        if compiler.latest != Some(design) {
            compiler.latest = Some(design);
            // Nobody listens if the thread could not start or has died.
            if let Some(wishes) = &compiler.wishes {
                let _ = wishes.send(CompileRequest { design, workgroup, haste });
            }
        }
    }

    /// Takes the kernels that the thread has compiled since the last call.
    fn collect(&mut self) {
        let Some(compiler) = &self.compiler else { return };
        for Compiled { kernel, secs } in compiler.compiled.try_iter() {
            self.compile_secs += secs;
            if !self.kept.has(|kept| kept.design == kernel.design) {
                self.kept.add(kernel);
            }
        }
    }

    /// Forgets all kernels, because their device or their settings are gone.
    pub(super) fn clear(&mut self) {
        *self = Kernels { compile_secs: self.compile_secs, ..Kernels::default() };
    }

    /// Number of kernels kept.
    pub(super) fn len(&self) -> usize {
        self.kept.0.len()
    }

    /// Seconds spent on compiling, on all threads together.
    pub(super) fn compile_secs(&self) -> f64 {
        self.compile_secs
    }
}

/// The things used most recently, at most [`MAX_KERNELS`], the latest at the end.
struct RecentlyUsed<T>(Vec<Arc<T>>);

impl<T> Default for RecentlyUsed<T> {
    fn default() -> Self {
        RecentlyUsed(Vec::new())
    }
}

impl<T> RecentlyUsed<T> {
    fn has(&self, is_it: impl Fn(&T) -> bool) -> bool {
        self.0.iter().any(|kept| is_it(kept))
    }

    /// Returns the first thing that `is_it` accepts, and marks it as the latest used.
    fn get(&mut self, is_it: impl Fn(&T) -> bool) -> Option<Arc<T>> {
        let place = self.0.iter().position(|kept| is_it(kept))?;
        self.0[place..].rotate_left(1);
        self.0.last().cloned()
    }

    /// Adds a thing and, if there are too many, drops the least recently used one, which stays
    /// alive while it is in use elsewhere.
    fn add(&mut self, thing: T) -> Arc<T> {
        if self.0.len() >= MAX_KERNELS {
            self.0.remove(0);
        }
        let thing = Arc::new(thing);
        self.0.push(Arc::clone(&thing));
        thing
    }
}

/// Moment at which a kernel is compiled in the background.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CompileWhen {
    /// The kernel is compiled as soon as possible.
    Now,
    /// The kernel is compiled once no other has been requested for a while.
    AfterRest,
}

/// A kernel to compile in the background.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CompileRequest {
    design: Design,
    workgroup: u32,
    haste: CompileWhen,
}

/// A kernel that was compiled in the background, with the time that it took.
struct Compiled {
    kernel: Kernel,
    secs: f64,
}

/// A thread that compiles the kernel requested last.
struct KernelCompiler {
    wishes: Option<Sender<CompileRequest>>,
    compiled: Receiver<Compiled>,
    latest: Option<Design>,
    thread: Option<JoinHandle<()>>,
}

impl KernelCompiler {
    fn new(device: &wgpu::Device) -> Self {
        let (wishes, wished) = channel();
        let (done, compiled) = channel();
        let device = device.clone();
        let work = move || {
            while let Some(wish) = next_request(&wished, REST) {
                let begun = Instant::now();
                match compile(&device, &wish) {
                    Ok(kernel) => {
                        let secs = begun.elapsed().as_secs_f64();
                        if done.send(Compiled { kernel, secs }).is_err() {
                            return;
                        }
                    }
                    Err(why) => log::warn!("the general kernel stays in use: {why}"),
                }
            }
        };
        let thread = std::thread::Builder::new().name("kernels".to_string()).spawn(work);
        let thread = thread.inspect_err(|error| log::warn!("no thread for kernels: {error}")).ok();
        KernelCompiler { wishes: Some(wishes), compiled, latest: None, thread }
    }
}

impl Drop for KernelCompiler {
    /// Waits for the thread: a driver that is still at work when the process ends may crash it.
    fn drop(&mut self) {
        self.wishes = None;
        // A panic in the thread was reported when it happened.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// Waits for the next request to carry out, skipping those that newer ones replace; returns `None`
/// once the sender is gone.
fn next_request(wishes: &Receiver<CompileRequest>, rest: Duration) -> Option<CompileRequest> {
    let mut wish = wishes.recv().ok()?;
    while wish.haste == CompileWhen::AfterRest {
        match wishes.recv_timeout(rest) {
            Ok(newer) => wish = newer,
            Err(RecvTimeoutError::Timeout) => break,
            Err(RecvTimeoutError::Disconnected) => return None,
        }
    }
    Some(wish)
}

/// Compiles a kernel on the background thread; returns its errors, which do not concern the engine.
fn compile(device: &wgpu::Device, wish: &CompileRequest) -> Result<Kernel, String> {
    use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
    let scopes = [Validation, OutOfMemory, Internal].map(|filter| device.push_error_scope(filter));
    let kernel = Kernel::compile(device, wish.design, wish.workgroup);
    // Every scope has to be closed, the innermost first.
    let pops = scopes.into_iter().rev().map(|scope| now(scope.pop()).flatten());
    let errors: Vec<wgpu::Error> = pops.flatten().collect();
    errors.first().map_or(Ok(kernel), |error| Err(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::level::{BALANCED, FAST, LESSON};

    #[test]
    fn the_kernels_used_last_are_kept() {
        let mut kept = RecentlyUsed::default();
        for k in 0..MAX_KERNELS {
            kept.add(k);
        }
        let held = kept.get(|&k| k == 1).unwrap();
        // The first is used again, so that the third is now the oldest.
        assert_eq!(kept.get(|&k| k == 0).as_deref(), Some(&0));
        kept.add(100);
        kept.add(101);
        assert_eq!(kept.0.len(), MAX_KERNELS);
        let has = |k: usize| kept.has(|&kept| kept == k);
        assert!(has(0) && has(1) && has(100) && has(101) && !has(2) && !has(3) && has(4));
        for k in 200..200 + MAX_KERNELS {
            kept.add(k);
        }
        assert!(kept.get(|&k| k == 1).is_none());
        assert_eq!(*held, 1, "what is in use stays alive");
    }

    fn wish(config: &crate::IntegratorConfig, haste: CompileWhen) -> CompileRequest {
        CompileRequest {
            design: Design::general(config, false, false).unwrap(),
            workgroup: 64,
            haste,
        }
    }

    #[test]
    fn only_the_scene_that_rests_is_compiled() {
        let (sender, wishes) = channel();
        let [first, second] = [LESSON, FAST].map(|config| wish(&config, CompileWhen::AfterRest));
        let rest = Duration::from_millis(50);
        sender.send(first).unwrap();
        sender.send(second).unwrap();
        let begun = Instant::now();
        assert_eq!(next_request(&wishes, rest), Some(second));
        assert!(begun.elapsed() >= rest);
        let urgent = wish(&BALANCED, CompileWhen::Now);
        sender.send(urgent).unwrap();
        assert_eq!(next_request(&wishes, Duration::from_secs(600)), Some(urgent));
        // Nobody waits for the rest of a scene when the engine is gone.
        sender.send(first).unwrap();
        drop(sender);
        assert_eq!(next_request(&wishes, Duration::from_secs(600)), None);
    }
}
