//! The extension module `iva._iva`, which takes Python values and returns Arrow tables.
//!
//! [`arguments`] reads what Python hands over → [`calls`] are the functions of the module →
//! [`worker`] runs them away from the interpreter → [`arrow_table`] hands the result back.
//! [`record`] holds recorded forces. [`files`] reads result files through iva-store. [`errors`] converts
//! errors into Python exceptions. There is no physics here.

mod arguments;
mod arrow_table;
mod attractors;
mod branches;
mod calls;
mod dynamics;
mod errors;
mod explored;
mod files;
mod folder;
mod optimised;
mod record;
mod scenes;
mod study;
mod theory;
mod worker;

use pyo3::prelude::*;

/// The compiled half of `iva`; use the names that `iva` itself exports.
#[pymodule]
mod _iva {
    #[pymodule_export]
    use super::arrow_table::ArrowTable;
    #[pymodule_export]
    use super::attractors::{attractors, basins, diagram, lyapunov};
    #[pymodule_export]
    use super::branches::{curve, follow, orbit_at, switch};
    #[pymodule_export]
    use super::calls::{
        check, check_choices, check_restitution_table, column_units, design, doubts, fields,
        gradients, larger_is_better, main, modes, primary_units, simulate, state, state_of_modes,
        states, trajectory, unit_system, verdict_on_contacts, verify,
    };
    #[pymodule_export]
    use super::dynamics::orbit;
    #[pymodule_export]
    use super::errors::IvaError;
    #[pymodule_export]
    use super::explored::scene_of_study;
    #[pymodule_export]
    use super::files::{
        check_files, copy_examples, empty_tables, example_names, metadata, read_table, visible,
    };
    #[pymodule_export]
    use super::folder::{PySweepFolder, sweep_into};
    #[pymodule_export]
    use super::optimised::{in_range, optimised_scene, sampled};
    #[pymodule_export]
    use super::record::{PyRecord, kind_of_file, read_record};
    #[pymodule_export]
    use super::study::PyStudy;
    #[pymodule_export]
    use super::theory::{masri_caughey, on_slow_manifold, slow_manifold};

    /// The newest table layout that this version writes and reads.
    #[pymodule_export]
    const SCHEMA_VERSION: u32 = iva_sweep::columns::SCHEMA_VERSION;

    /// Version of the package.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
