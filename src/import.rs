//! Files from elsewhere: a robot file from a URDF, a task file from a tool path of CAM.

pub use stead_format::cam::gcode::Machine;
pub use stead_format::cam::{
    CamFormat, ImportedPath, LengthUnit, ReadSettings as PathSettings, Resampling, import_path,
};
pub use stead_format::urdf::{Deviation, HomePose, ImportOptions, ImportedRobot, ImportedRow, import_robot};
