//! What rides on the structure: [`siva`], a free mass in a gap; [`piva`], a pendulum between two stops; [`coupled`], a free
//! mass with a spring and a dashpot in its gap.
//!
//! [`system`] is the interface that an absorber implements. [`impact`] is the law of an impact, [`chatter`] that of
//! infinitely many; [`ride`] is what follows them, the motion with the absorber stuck to its wall.

pub mod alone;
pub mod chatter;
pub mod coupled;
pub mod derivatives;
pub mod impact;
pub mod piva;
pub(crate) mod plain;
pub mod ride;
pub mod siva;
pub mod system;
