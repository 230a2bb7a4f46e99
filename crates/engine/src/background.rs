//! An engine on a thread of its own, for callers that must never wait.
//!
//! Opening an engine compiles kernels and may measure the machine; polling one may compute. Here
//! both happen on a thread that takes jobs from a channel, sends answers back, and wakes the caller
//! whenever it has sent some. To the caller it is an [`Engine`] like any other.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use super::choice::{ChoiceError, Chosen};
use super::depth::Following;
use super::{Engine, EngineError, EngineKind, GpuStats, IntegratorConfig, Job, JobResult, Wait};
use crate::clock::Instant;

/// Length of one poll, after which the thread looks for new orders again.
const TURN: Duration = Duration::from_millis(4);
/// Number of jobs queued behind those that the engine works on, to keep it busy between two frames.
const AHEAD: usize = 1;

/// A message from the caller to the thread.
enum Order {
    Submit(Box<Job>),
    /// Drops all jobs. The answers that follow carry this number.
    Cancel(u64),
    BeginPicture,
}

/// A message from the thread to the caller, with the number of the last cancellation it has seen.
type Reply = (u64, Result<JobResult, EngineError>);

/// An engine that is being opened.
pub struct PendingEngine {
    receiver: Receiver<Result<Background, ChoiceError>>,
}

/// An engine that runs on its own thread, as its caller sees it.
pub struct Background {
    /// Reason for the choice of the engine, in words for the user.
    pub why: String,
    /// The configuration that the engine was opened for.
    pub config: IntegratorConfig,
    /// Progress in following the middle of a deep view.
    pub following: Following,
    orders: Sender<Order>,
    answers: Receiver<Reply>,
    cancellations: u64,
    in_flight: usize,
    slots: usize,
    job_size: usize,
    kind: EngineKind,
    adapter: String,
    offered: Offered,
    stats: Arc<Mutex<Option<GpuStats>>>,
    /// Joins the thread. This field is dropped last, because the thread ends only once `orders` is
    /// gone.
    _ended: JoinOnDrop,
}

/// Waits for a thread, if there is one, to end. A driver that is still working when the process
/// ends may crash it.
struct JoinOnDrop(Option<JoinHandle<()>>);

impl Drop for JoinOnDrop {
    fn drop(&mut self) {
        // A panic in the thread has already been reported as a lost device.
        let _ = self.0.take().map(JoinHandle::join);
    }
}

/// A function that tests whether an engine on another thread offers a configuration.
type Offered = Box<dyn Fn(&IntegratorConfig) -> bool + Send>;

/// Opens an engine on a new thread; `wake` is called whenever there is news.
pub fn open(
    choose: impl FnOnce() -> Result<Chosen, ChoiceError> + Send + 'static,
    wake: impl Fn() + Send + 'static,
) -> std::io::Result<PendingEngine> {
    let (sender, receiver) = channel();
    std::thread::Builder::new().name("engine".to_string()).spawn(move || {
        match choose() {
            Err(error) => {
                // If the receiver is gone, the window is closed, and nobody needs the error.
                let _ = sender.send(Err(error));
                wake();
            }
            Ok(chosen) => {
                let Chosen { mut engine, config, why, following, .. } = chosen;
                let opened_for = config;
                let offered = Box::new(move |config: &IntegratorConfig| *config == opened_for);
                let words = (why, config, following);
                let (background, served) = Background::beside(engine.as_ref(), words, offered);
                if sender.send(Ok(background)).is_ok() {
                    wake();
                    serve(engine.as_mut(), &served, &wake);
                }
            }
        }
    })?;
    Ok(PendingEngine { receiver })
}

impl PendingEngine {
    /// Returns the engine, or the reason why there is none; `None` while it is being opened.
    pub fn poll(&self) -> Option<Result<Background, ChoiceError>> {
        self.receiver.try_recv().ok()
    }

    /// Waits for the engine; returns `None` if its thread died.
    #[cfg(test)]
    fn wait(self) -> Option<Result<Background, ChoiceError>> {
        self.receiver.recv().ok()
    }
}

/// Moves an open engine to a thread of its own; `offered` returns true for the configurations that
/// the engine has.
pub(crate) fn on_its_own_thread(
    mut engine: impl Engine + Send + 'static,
    config: IntegratorConfig,
    why: &str,
    offered: impl Fn(&IntegratorConfig) -> bool + Send + 'static,
) -> std::io::Result<Background> {
    let words = (why.to_string(), config, Following::default());
    let (background, served) = Background::beside(&engine, words, Box::new(offered));
    let thread = std::thread::Builder::new()
        .name("device".to_string())
        .spawn(move || serve(&mut engine, &served, &|| ()))?;
    Ok(Background { _ended: JoinOnDrop(Some(thread)), ..background })
}

/// The thread's ends of the channels.
struct Served {
    orders: Receiver<Order>,
    answers: Sender<Reply>,
    stats: Arc<Mutex<Option<GpuStats>>>,
}

/// Runs the thread's loop until the caller is gone.
fn serve(engine: &mut dyn Engine, served: &Served, wake: &dyn Fn()) {
    let Served { orders, answers, stats } = served;
    let (mut number, mut in_flight) = (0, 0usize);
    loop {
        let order = if in_flight == 0 {
            orders.recv().map_err(|_| TryRecvError::Disconnected)
        } else {
            orders.try_recv()
        };
        let answered = match order {
            Ok(Order::Submit(job)) => {
                let submitted = engine.submit(*job);
                in_flight += usize::from(submitted.is_ok());
                submitted.map(|()| Vec::new())
            }
            Ok(Order::Cancel(latest)) => {
                engine.cancel();
                (number, in_flight) = (latest, 0);
                Ok(Vec::new())
            }
            Ok(Order::BeginPicture) => {
                engine.begin_picture();
                Ok(Vec::new())
            }
            Err(TryRecvError::Empty) => engine.poll(Wait::Until(Instant::now() + TURN)),
            Err(TryRecvError::Disconnected) => return,
        };
        let news: Vec<Result<JobResult, EngineError>> = match answered {
            Ok(finished) => {
                in_flight -= finished.len();
                finished.into_iter().map(Ok).collect()
            }
            Err(error) => {
                // Jobs in flight are lost with the error; the caller decides which to submit again.
                engine.cancel();
                in_flight = 0;
                vec![Err(error)]
            }
        };
        let any = !news.is_empty();
        if any {
            *stats.lock().expect("no panic while held") = engine.gpu_stats();
        }
        for answer in news {
            if answers.send((number, answer)).is_err() {
                return;
            }
        }
        if any {
            wake();
        }
    }
}

impl Background {
    /// Returns the caller's view of an engine, and the thread's ends of the channels between the
    /// two.
    fn beside(
        engine: &dyn Engine,
        (why, config, following): (String, IntegratorConfig, Following),
        offered: Offered,
    ) -> (Background, Served) {
        let (orders, taken) = channel();
        let (given, answers) = channel();
        let stats = Arc::new(Mutex::new(engine.gpu_stats()));
        let background = Background {
            why,
            config,
            following,
            orders,
            answers,
            cancellations: 0,
            in_flight: 0,
            slots: engine.slots() + AHEAD,
            job_size: engine.job_size(),
            kind: engine.kind(),
            adapter: engine.adapter(),
            offered,
            stats: stats.clone(),
            _ended: JoinOnDrop(None),
        };
        (background, Served { orders: taken, answers: given, stats })
    }

    /// Takes an answer, unless its job was cancelled.
    fn take(&mut self, (number, answer): Reply) -> Option<Result<JobResult, EngineError>> {
        if number != self.cancellations {
            return None;
        }
        self.in_flight = if answer.is_ok() { self.in_flight.saturating_sub(1) } else { 0 };
        Some(answer)
    }

    fn gone() -> EngineError {
        EngineError::DeviceLost("its thread ended".to_string())
    }
}

impl Engine for Background {
    fn submit(&mut self, job: Job) -> Result<(), EngineError> {
        self.in_flight += 1;
        self.orders.send(Order::Submit(Box::new(job))).map_err(|_| Self::gone())
    }

    fn poll(&mut self, wait: Wait) -> Result<Vec<JobResult>, EngineError> {
        let mut finished = Vec::new();
        while self.in_flight > 0 {
            match self.answers.try_recv() {
                Ok(answer) => {
                    finished.extend(self.take(answer).transpose()?);
                    continue;
                }
                Err(TryRecvError::Disconnected) => return Err(Self::gone()),
                Err(TryRecvError::Empty) if !finished.is_empty() => break,
                Err(TryRecvError::Empty) => {}
            }
            match wait.receive(&self.answers) {
                Ok(answer) => finished.extend(self.take(answer).transpose()?),
                Err(RecvTimeoutError::Timeout) => break,
                Err(RecvTimeoutError::Disconnected) => return Err(Self::gone()),
            }
        }
        Ok(finished)
    }

    fn cancel(&mut self) {
        self.cancellations += 1;
        self.in_flight = 0;
        // An engine that is gone has nothing to cancel; submitting the next job reports it.
        let _ = self.orders.send(Order::Cancel(self.cancellations));
    }

    fn begin_picture(&mut self) {
        // As with a cancellation, the next job reports an engine that is gone.
        let _ = self.orders.send(Order::BeginPicture);
    }

    fn slots(&self) -> usize {
        self.slots
    }

    fn job_size(&self) -> usize {
        self.job_size
    }

    fn kind(&self) -> EngineKind {
        self.kind
    }

    fn adapter(&self) -> String {
        self.adapter.clone()
    }

    fn offers(&self, config: &IntegratorConfig) -> bool {
        (self.offered)(config)
    }

    fn gpu_stats(&self) -> Option<GpuStats> {
        *self.stats.lock().expect("no panic while held")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choice::EngineRequest;
    use crate::mock::MockEngine;
    use crate::{EventSpec, Keep, Method, Precision, Starts};
    use flipmap_numbers::Dd;
    use flipmap_pendulum::Rule;
    use flipmap_scene::PendulumSpec;

    fn chosen(engine: MockEngine) -> Result<Chosen, ChoiceError> {
        let config = IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };
        let (why, following) = ("a test".to_string(), Following::default());
        let request = EngineRequest::default();
        Ok(Chosen { engine: Box::new(engine), config, why, following, request })
    }

    fn background(engine: fn() -> MockEngine) -> Background {
        let opening = open(move || chosen(engine()), || ()).unwrap();
        opening.wait().unwrap().unwrap_or_else(|error| panic!("{error}"))
    }

    fn job(id: u64) -> Job {
        Job {
            id,
            question: EventSpec {
                build: PendulumSpec::default(),
                rule: Rule::Second,
                budget_secs: 30.0,
                passes: 1,
            },
            config: IntegratorConfig { method: Method::LESSON, precision: Precision::F32 },
            starts: Starts::Rest(vec![[Dd::new(id as f64); 2]]),
            keep: Keep::NOTHING,
        }
    }

    #[test]
    fn answers_are_those_of_the_engine_behind() {
        let mut engine = background(MockEngine::default);
        (0..3).for_each(|id| engine.submit(job(id)).unwrap());
        let mut ids = Vec::new();
        while ids.len() < 3 {
            for finished in engine.poll(Wait::UntilFinished).unwrap() {
                let Job { question, starts: Starts::Rest(angles), .. } = job(finished.id) else {
                    panic!("not from rest")
                };
                assert_eq!(finished.outcomes, [MockEngine::answer(&question, angles[0])]);
                ids.push(finished.id);
            }
        }
        assert_eq!(ids, [0, 1, 2]);
        assert!(engine.poll(Wait::UntilFinished).unwrap().is_empty(), "nothing flies, no waiting");
    }

    #[test]
    fn cancelled_jobs_never_answer() {
        let mut engine = background(MockEngine::default);
        (0..3).for_each(|id| engine.submit(job(id)).unwrap());
        engine.cancel();
        engine.submit(job(7)).unwrap();
        let mut ids = Vec::new();
        while ids.is_empty() {
            ids.extend(engine.poll(Wait::UntilFinished).unwrap().iter().map(|f| f.id));
        }
        assert_eq!(ids, [7]);
    }

    #[test]
    fn jobs_of_another_picture_come_after_its_beginning() {
        let config = IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };
        let (told, events) = channel();
        let engine = MockEngine { told: Some(told), ..MockEngine::default() };
        let mut engine = on_its_own_thread(engine, config, "a test", |_| true).unwrap();
        engine.submit(job(1)).unwrap();
        engine.begin_picture();
        engine.submit(job(2)).unwrap();
        // A job submitted just before the engine is dropped may never run.
        while !engine.poll(Wait::UntilFinished).unwrap().iter().any(|finished| finished.id == 2) {}
        drop(engine);
        assert_eq!(events.iter().collect::<Vec<_>>(), ["job 1", "picture", "job 2"]);
    }

    #[test]
    fn an_error_arrives_and_the_engine_goes_on() {
        let mut engine = background(|| MockEngine { fail_at: Some(0), ..MockEngine::default() });
        engine.submit(job(0)).unwrap();
        assert!(engine.poll(Wait::UntilFinished).is_err());
    }

    #[test]
    fn an_open_engine_moves_to_a_thread_and_offers_what_it_had() {
        let config = |precision| IntegratorConfig { method: Method::LESSON, precision };
        let lesson = config(Precision::F32);
        let offered = |config: &IntegratorConfig| config.precision != Precision::Dd;
        let mut engine =
            on_its_own_thread(MockEngine::default(), lesson, "a test", offered).unwrap();
        assert!(engine.offers(&config(Precision::F64)) && !engine.offers(&config(Precision::Dd)));
        engine.submit(job(3)).unwrap();
        let finished = engine.poll(Wait::UntilFinished).unwrap();
        assert_eq!((finished[0].id, engine.gpu_stats()), (3, None));
    }

    #[test]
    fn a_thread_has_ended_once_its_caller_is_gone() {
        let ended = Arc::new(Mutex::new(false));
        let end = Arc::clone(&ended);
        let thread = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(50));
            *end.lock().unwrap() = true;
        });
        drop(JoinOnDrop(Some(thread)));
        assert!(*ended.lock().unwrap());
    }

    #[test]
    fn it_says_when_it_could_not_be_opened() {
        let fail = || Err(ChoiceError::NoAdapter("none".to_string()));
        assert!(open(fail, || ()).unwrap().wait().unwrap().is_err());
    }
}
