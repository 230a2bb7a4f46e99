//! Paints the frames of a film from parts.

use super::merge::some_rows;
use super::task::{FrameGroupTask, TaskKind};
use super::{PartError, Parts, Task};
use crate::film::{
    Colours, FilmRenderError, FlipWindow, FramePainter, FramePixels, Mip, film_caption,
    film_legend, tones,
};
use crate::output::{Inset, RowPainter};
use flipmap_scene::PictureTable;
use flipmap_scene::film::{Film, Shot};

/// Returns the function that paints the frames of a film from its parts.
pub(crate) fn frames<'a>(
    task: &'a Task,
    picture: &'a PictureTable,
    parts: &'a mut Parts,
) -> Result<Box<FramePixels<'a>>, FilmRenderError> {
    match &task.work {
        TaskKind::Still(..) => Err(PartError::Gone.into()),
        TaskKind::Frames(film, frames) => Ok(Box::new(move |frame, shot| {
            let pass = &frames[frame as usize].pass;
            let mut painter = RowPainter::new(&shot.scene, film.size, picture)?;
            let (mut rgb, mut row) = (Vec::new(), 0);
            while row < pass.size[1] {
                let samples = some_rows(pass, parts, row)?;
                row += (samples.len() / pass.size[0] as usize) as u32;
                rgb.extend(painter.paint(&samples));
            }
            Ok(rgb)
        })),
        TaskKind::Film(film, groups) => {
            let mut frames = FlipFrames {
                colours: Colours::new(tones(film, picture)?, picture.relief > 0.0),
                painter: FramePainter::new(film.size, picture),
                legend: film_legend(film, picture)?,
                picture,
                last: None,
                task,
                film,
                groups,
                parts,
            };
            Ok(Box::new(move |frame, shot| frames.paint(frame, shot)))
        }
    }
}

/// The frames of a film of flips, painted from the patches of its groups.
struct FlipFrames<'a> {
    task: &'a Task,
    film: &'a Film,
    groups: &'a [FrameGroupTask],
    parts: &'a mut Parts,
    colours: Colours,
    painter: FramePainter,
    legend: Option<Inset>,
    picture: &'a PictureTable,
    /// The colours of the last frame's patches; its group and the flips that it shows.
    last: Option<(Mip, usize, FlipWindow)>,
}

impl FlipFrames<'_> {
    fn paint(&mut self, frame: u32, shot: &Shot) -> Result<Vec<u8>, FilmRenderError> {
        let group = self.groups.partition_point(|group| group.group.frames.end <= frame);
        let shown = FlipWindow::of(self.film, shot);
        let last = self.last.take().filter(|(_, of, flips)| (*of, *flips) == (group, shown));
        let mut mip = match last {
            Some((mip, ..)) => mip,
            None => {
                self.painter.forget();
                self.coloured(&self.groups[group], &shown)?
            }
        };
        let mut rgb = self.painter.paint(shot, &mut mip)?;
        self.last = Some((mip, group, shown));
        let caption = film_caption(self.film, self.picture, shot, self.legend.as_ref())?;
        for inset in self.legend.iter().chain(&caption) {
            inset.lay_over(&mut rgb, self.film.size[0]);
        }
        Ok(rgb)
    }

    /// Builds the mip of a group's patches, in a file beside the parts.
    fn coloured(
        &mut self,
        group: &FrameGroupTask,
        shown: &FlipWindow,
    ) -> Result<Mip, FilmRenderError> {
        let mut patches = group.group.patches.iter();
        let mut looks = || {
            let patch = patches.next().ok_or(PartError::Gone)?;
            let (cell, mirrored) = patch.canonical();
            let samples = self.parts.patch(group.of(&cell), &cell)?;
            let samples = if mirrored { samples.image(samples.len()) } else { samples };
            Ok(self.colours.looks(&samples, &group.group.shown(patch, *shown)))
        };
        let (patches, folder) = (&group.group.patches, &self.task.folder);
        Mip::build(patches, self.colours.is_lit(), folder, &mut looks)
    }
}
