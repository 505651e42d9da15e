//! A folder that is taken for a sweep, before the first of its parts is run: what it holds decides if the
//! sweep begins, goes on, or gathers beside earlier tables until it is complete.

use std::path::Path;

use crate::claim::{Claim, end_exchange};
use crate::directory::Directory;
use crate::error::Error;
use crate::fault::Fault;
use crate::folder::{MANIFEST_FILE, holds_tables, manifest_text, refuse_conflicts, study_text};
use crate::hidden::{holds_kept_sweep, make_new_folder, new_folder, remove_new_folder};
use crate::inputs::Input;
use crate::manifest::Manifest;
use crate::remedy::Remedy;
use crate::sweep_folder::{Resumed, SweepFolder};

/// What may be done with what a folder holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Allowed {
    /// Go on with the sweep that it holds.
    pub resume: bool,
    /// Replace the tables that it holds, once the new ones are complete.
    pub overwrite: bool,
}

impl Allowed {
    fn any(self) -> bool {
        self.resume || self.overwrite
    }
}

/// A folder that no other process writes into.
pub struct Taken {
    claim: Claim,
    allowed: Allowed,
    replaces: bool,
}

/// A sweep that a folder holds.
pub struct Earlier {
    root: Directory,
    manifest: Manifest,
}

impl Earlier {
    /// What is complete of it.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Its resolved study; nothing if that is gone.
    ///
    /// # Errors
    /// [`Error::Io`] if it is there and cannot be read.
    pub fn study_text(&self) -> Result<String, Error> {
        Ok(study_text(&self.root)?.unwrap_or_default())
    }

    /// Says that it is not the sweep to go on with.
    pub fn refused(&self, differences: Vec<String>) -> Error {
        let dir = self.root.path().to_owned();
        Error::folder(Fault::OtherSweep { dir, differences }, Remedy::OtherFolderOrNotResume)
    }
}

/// Ends what a killed process began to move in a folder, and checks that it can take a result, as far as
/// that shows from what it holds.
///
/// # Errors
/// [`Error::Folder`] if it cannot; [`Error::Io`] if it cannot be read.
pub fn look(dir: &Path, allowed: Allowed) -> Result<(), Error> {
    end_exchange(dir)?;
    refuse_conflicts(dir, allowed.any())
}

impl Taken {
    /// Takes a folder for the sweep of a study; `text` is the resolved study.
    ///
    /// # Errors
    /// [`Error::Folder`] if the folder cannot be written, another process has it, or it holds what must not
    /// be replaced; [`Error::Io`] if it cannot be read.
    pub fn take(dir: &Path, allowed: Allowed, text: &str) -> Result<Self, Error> {
        let claim = Claim::take(dir)?;
        // What it holds may have changed before it was ours.
        refuse_conflicts(dir, allowed.any())?;
        let replaces = replaces(claim.dir(), allowed, text)?;
        Ok(Self { claim, allowed, replaces })
    }

    /// True if the sweep is to gather in `.iva-new`, with the tables of the folder as they are until the end.
    pub fn replaces(&self) -> bool {
        self.replaces
    }

    /// The sweep that the folder holds, if going on is allowed.
    ///
    /// # Errors
    /// [`Error::Folder`] if its manifest cannot be understood; [`Error::Io`] if it cannot be read.
    pub fn earlier(&self) -> Result<Option<Earlier>, Error> {
        let root = match (self.allowed.resume, self.replaces) {
            (false, _) => None,
            (true, false) => Some(self.claim.dir().itself()?),
            (true, true) => new_folder(self.claim.dir())?,
        };
        let Some(root) = root else { return Ok(None) };
        let Some(text) = manifest_text(&root)? else { return Ok(None) };
        let manifest = Manifest::parse(&text).map_err(|reason| {
            let path = root.path().join(MANIFEST_FILE);
            Error::folder(Fault::BadManifest { path, reason }, Remedy::BeginAnew)
        })?;
        Ok(Some(Earlier { root, manifest }))
    }

    /// Goes on with a sweep. Returns its folder, with the names of files that are not what its manifest
    /// says and are to be computed again; files that are `elsewhere` are taken on trust. `None`: `go_on`
    /// returned false, and nothing was changed.
    ///
    /// # Errors
    /// [`Error::Io`] if a file is there and cannot be read, or something cannot be written.
    pub fn resume(
        self,
        earlier: Earlier,
        study_and_inputs: (&str, &[Input]),
        elsewhere: bool,
        go_on: &dyn Fn() -> bool,
    ) -> Result<Option<Resumed>, Error> {
        let Earlier { root, manifest } = earlier;
        SweepFolder::resume(root, self.claim, manifest, study_and_inputs, elsewhere, go_on)
    }

    /// Begins a sweep, of which no part is complete.
    ///
    /// # Errors
    /// [`Error::Folder`] if a file that is not `iva`'s stands where an input must go; [`Error::Io`] if
    /// something cannot be written.
    pub fn begin(
        self,
        manifest: Manifest,
        (text, inputs): (&str, &[Input]),
    ) -> Result<SweepFolder, Error> {
        let root = if self.replaces {
            remove_new_folder(self.claim.dir())?;
            make_new_folder(self.claim.dir())?
        } else {
            self.claim.dir().itself()?
        };
        SweepFolder::begin(root, self.claim, manifest, text, inputs)
    }
}

fn replaces(dir: &Directory, allowed: Allowed, text: &str) -> Result<bool, Error> {
    let has_tables = holds_tables(dir)?;
    if allowed.overwrite && (has_tables || holds_kept_sweep(dir)?) {
        return Ok(true);
    }
    if allowed.resume && has_tables && dir.kind(Path::new(MANIFEST_FILE))?.is_none() {
        // Nothing says that they are complete: they stay until the new ones are.
        if study_text(dir)?.as_deref() == Some(text) {
            return Ok(true);
        }
        let fault = Fault::OtherTables(dir.path().to_owned());
        return Err(Error::folder(fault, Remedy::OtherFolderOrReplace));
    }
    Ok(false)
}
