//! Checks that no output of a command is also one of its inputs or another output.

use std::path::Path;

use flipmap_render::film::Frames;
use flipmap_render::output::{is_one_file, is_stdout};

use super::exit::Exit;

/// A file with its name in messages: an option, or a description such as "the scene".
pub(super) type Named<'a> = (&'a str, &'a Path);

/// Rejects an output that is the same file as an input or another output, under any name.
pub(super) fn keep_apart(inputs: &[Named], outputs: &[Named]) -> Result<(), Exit> {
    for (k, (name, path)) in outputs.iter().enumerate() {
        let others = inputs.iter().chain(&outputs[..k]);
        if let Some((other, _)) = others.into_iter().find(|(_, earlier)| is_one_file(earlier, path))
        {
            return Err(Exit::Usage(format!(
                "{other} and {name} name the same file; give each its own"
            )));
        }
    }
    Ok(())
}

/// Rejects more than one output on standard output; `json` counts as one.
pub(super) fn one_stream(outputs: &[Named], json: bool) -> Result<(), Exit> {
    let streams = outputs.iter().filter(|(_, path)| is_stdout(path)).map(|(name, _)| *name);
    let streams: Vec<&str> = streams.chain(json.then_some("--json")).collect();
    if streams.len() < 2 {
        return Ok(());
    }
    Err(Exit::Usage(format!(
        "{} would all be written to standard output, which takes one: name a file for the others",
        streams.join(" and ")
    )))
}

/// Rejects an input that is named like a frame and lies in the film's folder, which would replace
/// it.
pub(super) fn keep_from_frames(inputs: &[Named], folder: &Path) -> Result<(), Exit> {
    for (name, path) in inputs {
        let place = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        let Some(file) = place.file_name().and_then(|file| file.to_str()) else { continue };
        if Frames::are_named(file) && is_one_file(path, &folder.join(file)) {
            return Err(Exit::Usage(format!(
                "{name} {} is a frame in the folder of -o, which the film would replace: name \
                 another folder",
                path.display()
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_are_kept_apart_from_inputs_and_from_each_other() {
        let [scene, map] = ["scene.toml", "map.png"].map(Path::new);
        let here = Path::new("./scene.toml");
        let said = keep_apart(&[("the scene", scene)], &[("-o", map), ("--raw", here)]);
        assert!(said.unwrap_err().to_string().contains("the scene and --raw name the same file"));
        let said = keep_apart(&[], &[("-o", here), ("--raw", scene)]);
        assert!(said.unwrap_err().to_string().contains("-o and --raw name the same file"));
        assert!(keep_apart(&[("the scene", scene)], &[("-o", map)]).is_ok());
        let streams = [("-o", Path::new("-")), ("--raw", Path::new("-"))];
        assert!(keep_apart(&[], &streams).is_ok(), "another check says what is wrong with it");
    }
}
