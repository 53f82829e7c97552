//! Why the program ends, as a number that scripts can rely on.

use gridwalk_render::Error as RenderError;
use gridwalk_render::image::Error as ImageError;

/// How the program ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All done.
    Ok,
    /// Done, but: the pictures differ, some rays are unfinished, the validation layer complained.
    Difference,
    /// The command line makes no sense.
    Usage,
    /// A scene, ray or picture file cannot be used.
    Input,
    /// No Vulkan device can serve.
    NoDevice,
    /// Out of memory, on the device or beside it.
    OutOfMemory,
    /// The device was lost, did not answer in time, or its driver failed.
    DeviceLost,
    /// A result cannot be written.
    Output,
    /// Ctrl-C.
    Interrupted,
    /// The signal to terminate.
    Terminated,
}

impl Exit {
    /// The exit status.
    pub const fn code(self) -> u8 {
        match self {
            Exit::Ok => 0,
            Exit::Difference => 1,
            Exit::Usage => 2,
            Exit::Input => 3,
            Exit::NoDevice => 4,
            Exit::OutOfMemory => 5,
            Exit::DeviceLost => 6,
            Exit::Output => 7,
            Exit::Interrupted => 130,
            Exit::Terminated => 143,
        }
    }
}

/// The same list for the help texts and the manual.
pub const HELP: &str = "\
Exit status:
    0  done
    1  done, but: the pictures differ, rays are unfinished, or --validate found something
    2  wrong usage
    3  a file that is read cannot be used
    4  no suitable device
    5  out of memory
    6  the device was lost or did not answer
    7  a file cannot be written
  130  interrupted (Ctrl-C)
  143  terminated by a signal";

/// An error with the exit status that it leads to.
#[derive(Debug)]
pub struct Failure {
    /// The exit status.
    pub exit: Exit,
    /// What to tell.
    pub error: anyhow::Error,
}

/// Result of everything that may end the program.
pub type Result<T, E = Failure> = std::result::Result<T, E>;

impl Failure {
    /// A failure with a message of its own.
    pub fn new(exit: Exit, message: impl Into<String>) -> Failure {
        Failure { exit, error: anyhow::Error::msg(message.into()) }
    }

    /// The command line makes no sense in a way that clap cannot see.
    pub fn usage(message: impl Into<String>) -> Failure {
        Failure::new(Exit::Usage, message)
    }

    /// The same failure, told as one of something larger.
    pub fn within(self, of: String) -> Failure {
        Failure { exit: self.exit, error: self.error.context(of) }
    }

    /// A file cannot be used.
    pub fn input(message: impl Into<String>) -> Failure {
        Failure::new(Exit::Input, message)
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Failure {
        use gridwalk_render::gridwalk::Error as LibraryError;
        let exit = match &error {
            RenderError::NoVulkan { .. } | RenderError::NoDevice { .. } | RenderError::NoSuchDevice { .. } => Exit::NoDevice,
            RenderError::NoValidationLayer | RenderError::Gridwalk(LibraryError::Unsuitable { .. }) => Exit::NoDevice,
            RenderError::Validation { .. } => Exit::Difference,
            RenderError::OutOfDeviceMemory { .. } | RenderError::OutOfHostMemory | RenderError::TooDense { .. } => Exit::OutOfMemory,
            RenderError::Gridwalk(LibraryError::Capacity { .. } | LibraryError::DeviceLimit { .. }) => Exit::OutOfMemory,
            RenderError::Setting { .. } | RenderError::Gridwalk(LibraryError::Option { .. }) => Exit::Usage,
            RenderError::Scene { .. } | RenderError::KeyFrame(_) => Exit::Input,
            RenderError::Interrupted => Exit::Interrupted,
            _ => Exit::DeviceLost,
        };
        Failure { exit, error: error.into() }
    }
}

impl From<gridwalk_render::gridwalk_scene::Error> for Failure {
    fn from(error: gridwalk_render::gridwalk_scene::Error) -> Failure {
        Failure { exit: Exit::Input, error: error.into() }
    }
}

impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Failure {
        let exit = match &error {
            ImageError::Write { .. } | ImageError::Exists { .. } | ImageError::Encode { .. } | ImageError::Ffmpeg { .. } => Exit::Output,
            ImageError::UnknownFormat { .. } | ImageError::Movie { .. } => Exit::Usage,
            _ => Exit::Input,
        };
        Failure { exit, error: error.into() }
    }
}
