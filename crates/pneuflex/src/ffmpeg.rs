//! The program `ffmpeg` as a process: it makes a video of pictures.

use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use crate::error::Error;
use crate::input_error::{InputError, InputErrorKind};

/// A video that is being made.
pub(crate) struct Ffmpeg {
    process: Child,
    out: PathBuf,
}

impl Ffmpeg {
    /// Whether there is such a program.
    ///
    /// # Errors
    /// There is none.
    pub fn is_there() -> Result<(), InputError> {
        let mut command = Command::new("ffmpeg");
        command.arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        if command.status().is_ok_and(|status| status.success()) {
            return Ok(());
        }
        let help = "install it (Debian: apt-get install ffmpeg), or write --to gif or --to png".to_owned();
        Err(InputError::new("a video is made by the program ffmpeg, which is not there")
            .of_kind(InputErrorKind::MissingProgram)
            .with_help(Some(help)))
    }

    /// Begins a video of pictures of a size, so many per second.
    pub fn begin([width, height]: [usize; 2], rate: f64, out: &Path) -> Result<Self, Error> {
        let mut command = Command::new("ffmpeg");
        command.args(["-loglevel", "error", "-y", "-f", "rawvideo", "-pixel_format", "rgb24"]);
        command.args(["-video_size", &format!("{width}x{height}"), "-framerate", &format!("{rate:.4}"), "-i", "-"]);
        // What plays everywhere has an even number of rows and columns, and less resolution in colour than in brightness.
        command.args([
            "-vf",
            "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
            "-pix_fmt",
            "yuv420p",
            "-movflags",
            "+faststart",
        ]);
        // A name is a file, whatever it looks like.
        command.args(["-f", "mp4"]).arg(format!("file:{}", out.display()));
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        let process = command.spawn().map_err(|e| InputError::new(format!("ffmpeg cannot be started: {e}")))?;
        Ok(Self { process, out: out.to_owned() })
    }

    /// Adds a picture: red, green and blue of every pixel.
    pub fn add(mut self, rgb: &[u8]) -> Result<Self, Error> {
        let is_taken = self.process.stdin.as_mut().is_some_and(|pipe| pipe.write_all(rgb).is_ok());
        if is_taken {
            return Ok(self);
        }
        // It has ended, and says why.
        self.end()?;
        Err(InputError::new("ffmpeg ended before the last picture").into())
    }

    /// Closes the video.
    pub fn end(mut self) -> Result<(), Error> {
        drop(self.process.stdin.take());
        let mut said = String::new();
        if let Some(errors) = self.process.stderr.as_mut() {
            let _ = errors.take(100_000).read_to_string(&mut said);
        }
        let status = self.process.wait().map_err(|e| InputError::new(format!("ffmpeg: {e}")))?;
        if status.success() {
            return Ok(());
        }
        let last = said.lines().rev().map(str::trim).find(|line| !line.is_empty()).unwrap_or("it did not say why");
        Err(InputError::about_file(&self.out, format!("ffmpeg cannot write it: {last}")).into())
    }
}
