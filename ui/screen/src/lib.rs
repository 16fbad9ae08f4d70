//! The common parts of the window: theme and widgets, the state of the running loop ([`live`]), alarms, the
//! operating field in 3-D ([`scene3d`]) and the outbox for the operator's commands.
// These macros panic if stderr or stdout is closed.
#![cfg_attr(not(test), deny(clippy::print_stderr, clippy::print_stdout))]

pub mod activity;
pub mod alarms;
pub mod background;
pub mod compare_cost;
pub mod deadlines;
pub mod degree_record;
pub mod double_buffer;
pub mod exports;
pub mod force_cloud;
pub mod frames;
pub mod history;
pub mod image_recorder;
pub mod link;
pub mod live;
pub mod loop_connection;
pub mod objects;
pub mod opener;
pub mod outbox;
pub mod picking;
pub mod readings;
pub mod recording;
pub mod renderer;
pub mod rolling;
pub mod run_log;
pub mod scene3d;
pub mod screenshot;
pub mod signals;
pub mod stderr;
pub mod steady_button;
pub mod stiffness;
pub mod theme;
pub mod units;
pub mod widgets;
