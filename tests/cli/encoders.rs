//! Films in one file: what ffmpeg writes, and what is said where it cannot.

use image::AnimationDecoder;
use image::codecs::webp::WebPDecoder;
use std::fs;

use crate::program::*;
use crate::video::{CPU, KEYS, folder, pixels, video};
use tempfile::TempDir;

#[test]
#[cfg_attr(no_ffmpeg, ignore = "FLIPMAP_NO_FFMPEG=1 declares that there is no ffmpeg")]
fn films_have_the_frames_that_were_asked_for() {
    let folder = folder();
    fs::write(folder.path().join("keys.toml"), KEYS).unwrap();
    let film = ["keys.toml", "--frames", "24", "--fps", "12", "--size", "64x48"];
    let cache = ["--cache", "samples"];
    for output in ["f.mp4", "f.mkv", "f.gif", "f.webp", "f"] {
        video(&folder, &[&film[..], &cache[..], &["-o", output]].concat());
    }
    for film in ["f.mp4", "f.mkv"] {
        let entries = "stream=nb_read_frames,width,height,r_frame_rate";
        let words = ["-v", "error", "-count_frames", "-show_entries", entries, "-of", "csv", film];
        let probed = tool(&folder, "ffprobe", &words);
        assert_eq!(String::from_utf8_lossy(&probed).trim(), "stream,64,48,12/1,24", "{film}");
    }
    let count = "-v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 f.gif";
    let counted = tool(&folder, "ffprobe", &count.split(' ').collect::<Vec<_>>());
    assert_eq!(String::from_utf8_lossy(&counted).trim(), "24");
    let file = std::io::BufReader::new(fs::File::open(folder.path().join("f.webp")).unwrap());
    let frames = WebPDecoder::new(file).unwrap().into_frames().collect_frames().unwrap();
    let [width, height] = [frames[0].buffer().width(), frames[0].buffer().height()];
    assert_eq!((frames.len(), width, height), (24, 64, 48));
    // A frame of the lossless film is identical to the picture.
    let decode = "-v error -i f.mkv -f rawvideo -pix_fmt rgb24 -";
    let raw = tool(&folder, "ffmpeg", &decode.split(' ').collect::<Vec<_>>());
    let bytes = 64 * 48 * 3;
    assert_eq!(raw.len(), 24 * bytes);
    for frame in [0, 11, 23] {
        let picture = pixels(&folder.path().join(format!("f/{frame:06}.png")));
        assert!(raw[frame * bytes..(frame + 1) * bytes] == picture.as_raw()[..], "frame {frame}");
    }
    // Equal frames give equal files.
    for name in ["mp4", "mkv", "gif", "webp"] {
        video(&folder, &[&film[..], &cache[..], &["-o", &format!("g.{name}")]].concat());
        let [f, g] = ["f", "g"].map(|film| fs::read(folder.path().join(format!("{film}.{name}"))));
        assert!(f.unwrap() == g.unwrap(), "{name}");
    }
}

#[test]
#[cfg_attr(no_ffmpeg, ignore = "FLIPMAP_NO_FFMPEG=1 declares that there is no ffmpeg")]
fn films_of_odd_sizes_rates_and_names_are_made() {
    let folder = folder();
    let zoom = ["--zoom-to", "home", "--center=1,1", "--width", "0.5", "--size", "33x25"];
    let odd = "a: %d-\n.mp4";
    let more = ["--fps", "30000/1001", "--frames", "5", "--quality", "40", "-o", odd];
    video(&folder, &[&zoom[..], &more].concat());
    let entries = "stream=nb_read_packets,width,height,r_frame_rate";
    let name = format!("file:{odd}");
    let words = ["-v", "error", "-count_packets", "-show_entries", entries, "-of", "csv", &name];
    let probed = tool(&folder, "ffprobe", &words);
    assert_eq!(String::from_utf8_lossy(&probed).trim(), "stream,34,26,30000/1001,5");
    video(&folder, &[&zoom[..], &["--frames", "1", "--full-chroma", "-o", "one.mp4"]].concat());
    let pixels = ["-v", "error", "-show_entries", "stream=pix_fmt", "-of", "csv=p=0", "one.mp4"];
    assert_eq!(String::from_utf8_lossy(&tool(&folder, "ffprobe", &pixels)).trim(), "yuv444p");
    for output in ["one.gif", "one.webp", "one.mkv"] {
        video(&folder, &[&zoom[..], &["--frames", "1", "-o", output]].concat());
    }
}

#[test]
#[cfg_attr(no_ffmpeg, ignore = "FLIPMAP_NO_FFMPEG=1 declares that there is no ffmpeg")]
fn a_film_on_standard_output_is_the_mp4_and_leaves_nothing_behind() {
    let folder = folder();
    let zoom =
        ["video", "--zoom-to", "filigree", "--size", "160x120", "--frames", "6", "--caption"];
    let film = flipmap(&folder, &[&zoom[..], &CPU, &["-o", "-"]].concat());
    assert!(film.status.success(), "{}", error_of(&film));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    flipmap(&folder, &[&zoom[..], &CPU, &["-o", "f.mp4"]].concat());
    assert!(film.stdout == fs::read(folder.path().join("f.mp4")).unwrap());
}

fn tool(folder: &TempDir, name: &str, words: &[&str]) -> Vec<u8> {
    let output = std::process::Command::new(name).args(words).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", error_of(&output));
    output.stdout
}

/// Installs a fake ffmpeg that runs a script; returns the folder for `PATH`.
#[cfg(unix)]
fn fake(folder: &TempDir, script: &str) -> String {
    use std::os::unix::fs::PermissionsExt;
    let path = folder.path().join("bin");
    fs::create_dir_all(&path).unwrap();
    let ffmpeg = path.join("ffmpeg");
    fs::write(&ffmpeg, format!("#!/bin/sh\n{script}\n")).unwrap();
    fs::set_permissions(&ffmpeg, fs::Permissions::from_mode(0o755)).unwrap();
    path.display().to_string()
}

#[cfg(unix)]
#[test]
fn an_ffmpeg_that_is_missing_lacks_a_codec_or_fails_is_told_apart() {
    let folder = folder();
    fs::write(folder.path().join("keys.toml"), KEYS).unwrap();
    let film = ["keys.toml", "--frames", "3", "--size", "32x24", "-o", "f.mp4"];
    let with_path = |path: &str| {
        let mut command = program(&folder, &[&["video"], &CPU[..], &film[..]].concat());
        let output = command.env("PATH", path).output().unwrap();
        (output.status.code(), error_of(&output))
    };
    let (code, error) = with_path("/nowhere");
    assert!(code == Some(2) && error.contains("apt-get install ffmpeg"), "{error}");
    let (code, error) = with_path(&fake(&folder, "echo ' V..... ffv1  FFmpeg video codec #1'"));
    assert!(
        code == Some(2) && error.contains("no encoder libx264 or libopenh264 or mpeg4"),
        "{error}"
    );
    let fails = "case \"$2\" in -encoders) echo libx264;; *) /bin/echo one >&2; /bin/echo 'disk \
                 quota exceeded' >&2; exit 1;; esac";
    let (code, error) = with_path(&fake(&folder, fails));
    assert_eq!(code, Some(2), "{error}");
    assert!(error.contains("anything was computed: one; disk quota exceeded"), "{error}");
    let listed = |others: &str| {
        let script = format!("case \"$2\" in -encoders) echo libx264;; *) {others};; esac");
        with_path(&format!("{}:/usr/bin:/bin", fake(&folder, &script)))
    };
    // On a full disk ffmpeg prints an error but still exits with success.
    let (code, error) = listed("cat >/dev/null; echo 'no space' >&2");
    assert!(code == Some(2) && error.contains("computed: no space"), "{error}");
    let (code, error) = listed("cat >/dev/null; echo on standard output");
    assert!(code == Some(2) && error.contains("computed: it wrote nothing"), "{error}");
    assert!(!folder.path().join("f.mp4.samples").exists(), "nothing was computed");
    // It writes what no film is, and one that ends after the trial.
    let last = "for last; do :; done; cat > ${last#file:}";
    let (code, error) = listed(&format!("case \"$6\" in *) {last};; esac"));
    assert_eq!(code, Some(1), "{error}");
    assert!(
        error.contains("ffmpeg was given 3 frames, and the film that it wrote has 0"),
        "{error}"
    );
    assert!(!folder.path().join("f.mp4").exists());
    let left: Vec<String> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with(".flipmap"))
        .collect();
    assert!(left.is_empty(), "{left:?}");
    assert!(folder.path().join("f.mp4.samples/plan.toml").exists(), "samples are kept");
}

#[cfg(unix)]
#[test]
#[cfg_attr(no_ffmpeg, ignore = "FLIPMAP_NO_FFMPEG=1 declares that there is no ffmpeg")]
fn an_ffmpeg_that_warns_of_what_does_no_harm_makes_films() {
    let folder = folder();
    let path = std::env::var("PATH").unwrap();
    let warns =
        format!("echo 'no version information available' >&2; PATH={path:?} exec ffmpeg \"$@\"");
    let path = format!("{}:{path}", fake(&folder, &warns));
    for output in ["f.mp4", "f.gif"] {
        let film = ["video", "--zoom-to", "home", "--frames", "3", "--size", "32x24", "-o", output];
        let film = [&film[..], &["--width", "1"], &CPU].concat();
        let output = program(&folder, &film).env("PATH", &path).output().unwrap();
        assert!(output.status.success(), "{}", error_of(&output));
    }
}

#[test]
fn the_call_of_ffmpeg_can_be_seen() {
    let folder = folder();
    let words = ["--zoom-to", "deep", "--size", "64x48", "--fps", "25", "--print-ffmpeg"];
    let streamed = refused(&folder, 2, &[&["video", "-o", "-"], &words[..]].concat());
    assert!(streamed.contains("--print-ffmpeg needs the film's file"), "{streamed}");
    let shown = video(&folder, &[&words[..], &["-o", "it's.mkv"]].concat());
    assert!(shown.starts_with("ffmpeg -hide_banner") && shown.contains("-video_size 64x48"));
    assert!(
        shown.contains("-c:v ffv1") && shown.trim_end().ends_with("'file:it'\\''s.mkv'"),
        "{shown}"
    );
}
