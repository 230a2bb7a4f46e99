//! The trust in a device: the self-check's verdict on its arithmetic, and the orbits that each
//! method has to compute correctly before its first job.

use super::device::is_software;
use super::kernel::Design;
use super::kernels::CompileWhen;
use super::selfcheck::{self, cannot_wait};
use super::waiting::{CAN_SLEEP, Waiting, now};
use super::{GpuEngine, GpuTuning};
use crate::adapters::{Check, Verdict};
use crate::{EngineError, IntegratorConfig};
use flipmap_scene::question::Needs;

impl GpuEngine {
    /// The arithmetic that the device is trusted with.
    pub fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// Returns true if there are kernels for the method in the precision, on any adapter.
    pub(crate) fn has(config: &IntegratorConfig) -> bool {
        Design::general(config, false, false).is_ok()
    }

    /// Refuses ends that the kernels of a configuration do not compute, on any adapter.
    pub(crate) fn require_ends(config: &IntegratorConfig, ends: Needs) -> Result<(), EngineError> {
        Design::general(config, false, false)?.returning(ends).map(drop)
    }

    /// Refuses a configuration that the kernels do not have or the device is not trusted with.
    pub(crate) fn require(&self, config: &IntegratorConfig) -> Result<(), EngineError> {
        Design::general(config, false, false)?;
        self.verdict.allows(config).map_err(EngineError::Unsupported)
    }

    /// Checks orbits by a configuration's method in its precision, unless that was done before. If
    /// they are wrong, the device is no longer trusted with the precision or, for expansions, with
    /// the method.
    pub(crate) fn check_orbits(&mut self, config: &IntegratorConfig) -> Result<(), EngineError> {
        now(self.check_orbits_by(config, Waiting::Sleep)).unwrap_or_else(|| Err(cannot_wait()))
    }

    /// Checks orbits by a configuration's method in its precision, unless that was done before, and
    /// waits for the device as it is told.
    pub async fn check_orbits_by(
        &mut self,
        config: &IntegratorConfig,
        waiting: Waiting<'_>,
    ) -> Result<(), EngineError> {
        let checked = (config.method.name(), config.precision);
        if self.checked.contains(&checked) {
            return Ok(());
        }
        self.checked.push(checked);
        let tuning = GpuTuning { at_once: false, ..self.tuning };
        let checks = self.orbits(config, tuning, waiting).await;
        if checks.is_err() {
            self.checked.pop();
        }
        self.judge_by(checks?);
        if let (true, Ok(general)) = (self.tuning.at_once, self.general(config)) {
            self.kernels.wish(&self.gpu, general, self.tuning.workgroup, CompileWhen::Now);
        }
        Ok(())
    }

    /// Computes the check of orbits with other settings, while jobs in flight wait.
    async fn orbits(
        &mut self,
        config: &IntegratorConfig,
        tuning: GpuTuning,
        waiting: Waiting<'_>,
    ) -> Result<Vec<Check>, EngineError> {
        if matches!(waiting, Waiting::Sleep) && !CAN_SLEEP {
            return Err(cannot_wait());
        }
        let (busy, losses) = (std::mem::take(&mut self.slots), self.losses);
        let own = std::mem::replace(&mut self.tuning, tuning);
        let checks = selfcheck::orbits_by(self, &[*config], waiting).await;
        self.tuning = own;
        if self.losses == losses {
            self.slots = busy;
        } else {
            busy.into_iter().try_for_each(|slot| self.start(slot.job))?;
        }
        checks
    }

    /// Returns true if the general kernel of a method and precision computes orbits correctly,
    /// which is checked before its first use.
    pub(super) fn is_general_trusted(
        &mut self,
        config: &IntegratorConfig,
    ) -> Result<bool, EngineError> {
        let (name, precision) = (config.method.name(), config.precision);
        let known = self.generals.iter().find(|known| (known.0, known.1) == (name, precision));
        if let Some((.., is_sound)) = known {
            return Ok(*is_sound);
        }
        let tuning = GpuTuning { at_once: false, general: true, ..self.tuning };
        let checks = now(self.orbits(config, tuning, Waiting::Sleep)).ok_or_else(cannot_wait)??;
        let is_sound = checks.iter().all(|check| check.passed);
        self.generals.push((name, precision, is_sound));
        Ok(is_sound)
    }

    /// Takes more checks into account, which can only reduce trust.
    fn judge_by(&mut self, checks: Vec<Check>) {
        let before = std::mem::take(&mut self.verdict);
        let pairs = before.pairs;
        let now = selfcheck::verdict([before.checks, checks].concat());
        self.verdict = Verdict {
            f32: before.f32 && now.f32,
            compensated: before.compensated && now.compensated,
            df32: before.df32 && now.df32,
            f64: before.f64 && now.f64,
            pairs,
            ..now
        };
    }

    /// Returns a function that says, on any thread, whether checks with a configuration run on the
    /// device. Expansions are left to the processor by a software adapter, which takes longer for
    /// them on the same cores, and by a window, which does not wait for their kernel to compile.
    pub(crate) fn checks(&self) -> impl Fn(&IntegratorConfig) -> bool + Send + 'static {
        let leaves_series = self.tuning.at_once || is_software(&self.gpu.adapter);
        let verdict = self.verdict.clone();
        move |config| {
            let is_left = leaves_series && config.method.is_series();
            GpuEngine::has(config) && verdict.allows(config).is_ok() && !is_left
        }
    }
}
