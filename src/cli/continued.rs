//! `--state`: resumes where an earlier render of the same scene stopped.

use std::path::{Path, PathBuf};

use anyhow::Context;
use flipmap_engine::choice::EngineRequest;
use flipmap_engine::{Engine, EngineKind, IntegratorConfig};
use flipmap_render::output::{Destination, RenderState, RunRecord, SafeFile, read_plain};
use flipmap_render::tiles::SavedPixels;
use flipmap_scene::Document;

use super::exit::Exit;

/// A state file, the state that was in it, and the state to write to it next.
pub(super) struct Continued {
    path: PathBuf,
    earlier: Option<RenderState>,
    document: Document,
    ran: Option<RunRecord>,
    kept: SavedPixels,
}

impl Continued {
    /// Reads the file if it exists, and makes sure that it can be written.
    pub(super) fn open(path: &Path, document: &Document) -> anyhow::Result<Self> {
        if path.as_os_str() == "-" {
            let message = "--state is read and written: name a file, not standard output";
            return Err(Exit::Usage(message.to_string()).into());
        }
        let earlier = if path.exists() { Some(read(path, document)?) } else { None };
        super::check(path, "--state")?;
        let document = document.clone();
        Ok(Continued {
            path: path.to_path_buf(),
            earlier,
            document,
            ran: None,
            kept: SavedPixels::default(),
        })
    }

    /// Requests the engine of the earlier render, unless the user chose one.
    pub(super) fn prefer_engine(&self, request: EngineRequest) -> EngineRequest {
        match &self.earlier {
            Some(RenderState { ran, .. }) => request.preferring(ran.engine, &ran.adapter),
            None => request,
        }
    }

    /// Refuses to resume with another engine or config, and takes over the saved pixels.
    pub(super) fn check_ran(
        &mut self,
        engine: &dyn Engine,
        config: IntegratorConfig,
    ) -> anyhow::Result<()> {
        let ran = ran(engine, config);
        if let Some(earlier) = self.earlier.take() {
            earlier
                .check_ran(&ran)
                .map_err(|why| Exit::Usage(format!("--state {} {why}", self.path.display())))?;
            super::tell(&format!(
                "flipmap: resuming {} pixels from {}",
                earlier.kept.paused(),
                self.path.display()
            ));
            self.kept = earlier.kept;
        }
        self.ran = Some(ran);
        Ok(())
    }

    /// Takes the saved pixels out; [`Self::put`] puts them back when the work is done.
    pub(super) fn take(&mut self) -> SavedPixels {
        std::mem::take(&mut self.kept)
    }

    /// Puts in the pixels saved by the work.
    pub(super) fn put(&mut self, kept: SavedPixels) {
        self.kept = kept;
    }

    /// Replaces the file with the new state.
    pub(super) fn write(self) -> anyhow::Result<()> {
        let ran = self.ran.context("a state cannot be written before its engine is chosen")?;
        let state = RenderState { ran, document: self.document.text(), kept: self.kept };
        let name = self.path.display();
        let written = || {
            let mut file = SafeFile::create(&Destination::from(self.path.as_path()))?;
            state.write(&mut file)?;
            file.finish()
        };
        written().with_context(|| format!("cannot write {name}"))
    }
}

/// Largest size of a state in bytes: that of a picture of a hundred million pixels.
const MAX_BYTES: u64 = 16 << 30;

fn read(path: &Path, document: &Document) -> Result<RenderState, Exit> {
    let refuse =
        |why: &dyn std::fmt::Display| Exit::Usage(format!("--state {} {why}", path.display()));
    let bytes =
        read_plain(path, MAX_BYTES).map_err(|error| refuse(&format!("cannot be read: {error}")))?;
    let state = RenderState::parse(&bytes).map_err(|why| refuse(&why))?;
    state.check_scene(document).map_err(|why| refuse(&why))?;
    Ok(state)
}

fn ran(engine: &dyn Engine, config: IntegratorConfig) -> RunRecord {
    let adapter = engine.adapter();
    // A processor is "2 threads, AVX2", of which only the second part matters.
    let adapter = match (engine.kind(), adapter.split_once(", ")) {
        (EngineKind::Cpu, Some((_, set))) => set.to_string(),
        _ => adapter,
    };
    RunRecord {
        engine: engine.kind(),
        adapter,
        method: config.method.name().to_string(),
        setting: config.method.setting(),
        precision: config.precision.to_string(),
    }
}
