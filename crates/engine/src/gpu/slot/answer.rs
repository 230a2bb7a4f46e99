//! The answer, read back when all pendulums of a job are done.

use bytemuck::Pod;
use rayon::prelude::*;

use super::{Slot, answer_bytes};
use crate::gpu::packing::Packing;
use crate::gpu::shared::{CountedOutcome, PackedWork, RawOutcome, from_parts, status_of};
use crate::integrator_state::{MAX_CARRIED_NUMBERS, carried_names};
use crate::pace::Pace;
use crate::{
    Carried, Effort, EngineError, FinalState, IntegratorState, Job, JobResult, Keep, NUMBERS,
    Precision, Starts, start,
};
use flipmap_pendulum::{Accumulators, Outcome, Status};
use flipmap_scene::question::Needs;

impl Slot {
    /// Reads the answer once it has been mapped. Returns `None` if the device was lost after that,
    /// and an error if the device lost pendulums.
    pub(super) fn read_answer(&self) -> Option<Result<JobResult, EngineError>> {
        let answer = &self.buffers.answer;
        let bytes = answer_bytes(&self.job, self.packing);
        // Reads the mapped memory in place, because a copy takes as long as all the work on it.
        let view = answer.slice(..bytes).get_mapped_range().ok()?;
        let read = if let Some(packing) = self.packing {
            let (work, words) = view.split_at(size_of::<PackedWork>());
            let words = Packed { packing, words: bytemuck::cast_slice(words) };
            self.packed_answer(bytemuck::from_bytes(work), words).map(Some)
        } else if self.job.question.passes == 1 {
            self.answer(Outcomes { raw: bytemuck::cast_slice(&view), passes: &[] })
        } else {
            let counted: Vec<CountedOutcome> = bytemuck::pod_collect_to_vec(&view);
            let (raw, passes): (Vec<_>, Vec<_>) =
                counted.into_iter().map(|counted| (counted.raw, counted.passes)).unzip();
            self.answer(Outcomes { raw: &raw, passes: &passes })
        };
        drop(view);
        answer.unmap();
        read.transpose()
    }

    /// The answer that packed outcomes give, if none is missing.
    fn packed_answer(&self, work: &PackedWork, packed: Packed) -> Result<JobResult, EngineError> {
        let count = self.job.starts.len();
        all_packed(count, work)?;
        let outcomes =
            all_ended(count, |k| packed.outcome(k), |raw, status| self.outcome(raw, status))?;
        let effort = self.effort(work.steps_and_looks());
        Ok(JobResult { id: self.job.id, outcomes, effort, ..Default::default() })
    }

    /// The answer that the outcomes of all pendulums give, if none is missing.
    fn answer(&self, ended: Outcomes) -> Result<Option<JobResult>, EngineError> {
        let raw = ended.raw;
        let outcomes = all_ended(raw.len(), |k| raw[k], |raw, status| self.outcome(raw, status))?;
        let mut finished = JobResult {
            id: self.job.id,
            effort: self.effort(steps_and_looks(raw)),
            ..Default::default()
        };
        if self.job.keep != Keep::NOTHING {
            let Some(mut states) = self.read_states(raw) else { return Ok(None) };
            if self.job.keep.ends != Needs::Outcome {
                finished.ends = self.ends(ended, &states);
            }
            if self.job.keep.states {
                self.add_counts(ended, &mut states);
                let states = states.into_iter().enumerate();
                let left = states.filter(|(i, _)| outcomes[*i].status == Status::Unflipped);
                finished.unfinished = left.collect();
            }
        }
        Ok(Some(JobResult { outcomes, ..finished }))
    }

    /// The end of each pendulum; a flip lies in the step that follows its state.
    fn ends(
        &self,
        Outcomes { raw, passes }: Outcomes,
        states: &[IntegratorState],
    ) -> Vec<FinalState> {
        let (reduced, _) = self.job.question.reduced();
        match self.job.keep.ends {
            Needs::Growth => {
                let end = |state| start::end_with_growth(&reduced, state);
                return states.par_iter().map(end).collect();
            }
            Needs::Extremum(_) => {
                return states.iter().map(start::end_with_extremum).collect();
            }
            Needs::Outcome | Needs::End => {}
        }
        let one = |(k, (raw, state)): (usize, (&RawOutcome, &IntegratorState))| {
            let flipped =
                (status_of(raw.status) == Some(Status::Answered)).then(|| from_parts(raw.moment));
            let clearance = f64::from(raw.clearance);
            let how = (&self.job.config, &self.pace);
            let mut end = start::end(&reduced, how, state, flipped, clearance);
            if let Pace::Adaptive(_) = self.pace {
                end.gathered.turns = turns_of(raw);
            }
            end.gathered.passes = passes_of(passes, k);
            end
        };
        raw.par_iter().zip(states).enumerate().map(one).collect()
    }

    /// Adds the turns and passes counted so far to states, if these are counted and nothing else is
    /// carried along.
    fn add_counts(&self, Outcomes { raw, passes }: Outcomes, states: &mut [IntegratorState]) {
        if !self.job.question.counts() || self.job.keep.ends.are_carried() {
            return;
        }
        for (k, (raw, state)) in raw.iter().zip(states).enumerate() {
            let (turns, passes) = (turns_of(raw), passes_of(passes, k));
            let gathered = Accumulators { turns, passes, ..Accumulators::NONE };
            state.carried = Some(Box::new(Carried::Counts(gathered)));
        }
    }

    /// The work for the job, from the numbers of its pendulums' steps and looks.
    fn effort(&self, [steps, looks]: [u64; 2]) -> Effort {
        let before: u64 = match &self.job.starts {
            Starts::Resumed { states, .. } => states.iter().map(|p| u64::from(p.steps)).sum(),
            Starts::Rest(_) | Starts::Upright(_) | Starts::Thrown(_) => 0,
            _ => start::states(&self.job).iter().flatten().map(|p| u64::from(p.steps)).sum(),
        };
        let steps = steps - before;
        let Job { config, question, .. } = &self.job;
        let rhs = config.method.rhs_per_step(config.precision);
        let per_look = match self.pace {
            // A look repeats its step and takes both ends' accelerations for each bob.
            Pace::Fixed(_) => rhs + 2 * question.rule.watched().len() as u64,
            Pace::Adaptive(_) => rhs,
        };
        Effort {
            depth: None,
            rhs_evaluations: rhs * steps + looks * per_look,
            steps,
            lane_steps: self.lane_steps + looks,
        }
    }

    fn outcome(&self, raw: &RawOutcome, status: Status) -> Outcome {
        let moment = from_parts(raw.moment);
        match (status, self.pace) {
            (Status::Answered, Pace::Fixed(steps)) => steps.outcome_of_pass(raw.steps, moment),
            (Status::Answered, Pace::Adaptive(adaptive)) => adaptive.outcome_of_pass(moment),
            _ => Outcome::without_time(status),
        }
    }

    fn read_states(&self, raw: &[RawOutcome]) -> Option<Vec<IntegratorState>> {
        let (count, offset) =
            (raw.len() * self.places.len(), answer_bytes(&self.job, self.packing));
        let answer = &self.buffers.answer;
        // For each number of each pendulum its value and, for two f32, its remainder.
        let states: Vec<[f64; 2]> = match self.job.config.precision {
            Precision::F32 => {
                read::<f32>(answer, offset, count)?.iter().map(|&x| [f64::from(x), 0.0]).collect()
            }
            Precision::Df32 => read::<[f32; 2]>(answer, offset, count)?
                .iter()
                .map(|parts| parts.map(f64::from))
                .collect(),
            _ => read::<f64>(answer, offset, count)?.iter().map(|&x| [x, 0.0]).collect(),
        };
        let ends = self.job.keep.ends;
        let count = NUMBERS + carried_names(ends).len();
        let paused = |i: usize| {
            let mut all = [0.0; NUMBERS + MAX_CARRIED_NUMBERS];
            for (k, places) in self.places.iter().enumerate() {
                let [high, low] = states[k * raw.len() + i];
                match *places {
                    [Some(value), Some(remainder)] => (all[value], all[remainder]) = (high, low),
                    [Some(value), None] => all[value] = high + low,
                    [None, _] => {}
                }
            }
            IntegratorState::from_numbers(raw[i].steps, &all[..count], ends)
        };
        Some((0..raw.len()).map(paused).collect())
    }
}

/// The words of packed outcomes.
struct Packed<'a> {
    packing: Packing,
    words: &'a [u32],
}

impl Packed<'_> {
    fn outcome(&self, k: usize) -> RawOutcome {
        let each = self.packing.words();
        self.packing.unpacked(&self.words[k * each..(k + 1) * each])
    }
}

/// The outcomes of pendulums as a kernel wrote them, and their passes where these are counted.
#[derive(Clone, Copy)]
struct Outcomes<'a> {
    raw: &'a [RawOutcome],
    passes: &'a [[u32; 4]],
}

/// Number of pendulums that a thread takes at a time.
const SHARE: usize = 1 << 12;

/// Returns the passes of a pendulum, or zeros if passes are not counted.
fn passes_of(passes: &[[u32; 4]], k: usize) -> [u32; 4] {
    passes.get(k).copied().unwrap_or_default()
}

/// Returns the status of a pendulum that has ended, or `None` for one that the device returned
/// unchanged, or with a flip that has no time.
fn ended(raw: &RawOutcome) -> Option<Status> {
    let is_sound = |status: &Status| {
        *status != Status::Answered || raw.moment.iter().all(|part| part.is_finite())
    };
    status_of(raw.status).filter(is_sound)
}

/// Returns the outcomes of `count` pendulums from what a device has written for each, or an error
/// if one has not ended.
fn all_ended(
    count: usize,
    raw: impl Fn(usize) -> RawOutcome + Sync,
    outcome: impl Fn(&RawOutcome, Status) -> Outcome + Sync,
) -> Result<Vec<Outcome>, EngineError> {
    let one = |k| {
        let raw = raw(k);
        ended(&raw).map(|status| outcome(&raw, status))
    };
    let all: Option<Vec<Outcome>> =
        (0..count).into_par_iter().with_min_len(SHARE).map(one).collect();
    all.ok_or_else(|| {
        let lost = (0..count).filter(|&k| ended(&raw(k)).is_none()).count();
        EngineError::LostPendulums { lost, count }
    })
}

/// Returns an error unless the words of all pendulums have been written, because unwritten words
/// mean nothing.
fn all_packed(count: usize, work: &PackedWork) -> Result<(), EngineError> {
    match count.abs_diff(work.packed as usize) {
        0 => Ok(()),
        lost => Err(EngineError::LostPendulums { lost, count }),
    }
}

/// Steps and looks of all pendulums.
fn steps_and_looks(raw: &[RawOutcome]) -> [u64; 2] {
    let each = raw.par_iter().with_min_len(SHARE);
    let steps = each.clone().map(|raw| u64::from(raw.steps)).sum();
    [steps, each.map(|raw| u64::from(raw.status >> 8)).sum()]
}

/// Whole turns of both bobs.
fn turns_of(raw: &RawOutcome) -> [i32; 2] {
    [raw.turns as i16, (raw.turns >> 16) as i16].map(i32::from)
}

/// Reads `count` values of a mapped buffer; returns `None` if the device was lost after it was
/// mapped.
pub(super) fn read<T: Pod>(buffer: &wgpu::Buffer, offset: u64, count: usize) -> Option<Vec<T>> {
    let bytes = offset..offset + (count * size_of::<T>()) as u64;
    let view = buffer.slice(bytes).get_mapped_range().ok()?;
    Some(bytemuck::pod_collect_to_vec(&view))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::shared::RUNNING;

    fn raw(status: u32) -> RawOutcome {
        RawOutcome { status, ..RawOutcome::default() }
    }

    /// Returns the statuses of pendulums, or an error message if some were lost.
    fn statuses(all: &[RawOutcome]) -> Result<Vec<Status>, String> {
        let all = all_ended(all.len(), |k| all[k], |_, status| Outcome::without_time(status));
        all.map(|all| all.iter().map(|outcome| outcome.status).collect())
            .map_err(|error| error.to_string())
    }

    #[test]
    fn pendulums_that_a_device_lost_are_not_taken_for_unflipped_ones() {
        // The number of looks above the low byte says nothing about the end.
        let [unflipped, flipped, failed] = [raw(0), raw(1 | 7 << 8), raw(3 | 1 << 8)];
        let ended = vec![Status::Unflipped, Status::Answered, Status::Failed];
        assert_eq!(statuses(&[unflipped, flipped, failed]), Ok(ended));
        for lost in [RUNNING, RUNNING | 3 << 8, Status::Forbidden as u32, 77] {
            let error = statuses(&[unflipped, raw(lost), flipped]).unwrap_err();
            assert!(error.contains("1 of 3 pendulums"), "{error}");
        }
        for moment in [[f32::NAN, 0.0], [0.5, f32::INFINITY]] {
            let flipped = RawOutcome { status: 1, moment, ..RawOutcome::default() };
            let error = statuses(&[unflipped, flipped]).unwrap_err();
            assert!(error.contains("1 of 2 pendulums"), "{error}");
            // The moment of a pendulum that did not flip means nothing.
            statuses(&[RawOutcome { status: 0, ..flipped }]).unwrap();
        }
    }

    #[test]
    fn words_that_were_not_written_are_not_read() {
        let work = |packed| PackedWork { packed, ..PackedWork::default() };
        assert!(all_packed(70, &work(70)).is_ok());
        for packed in [0, 6, 69, 134] {
            let error = all_packed(70, &work(packed)).unwrap_err().to_string();
            assert!(error.contains(&format!("{} of 70", packed.abs_diff(70))), "{error}");
        }
    }
}
