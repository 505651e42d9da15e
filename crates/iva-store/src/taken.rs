//! A folder locked for a sweep, before the first part is run: its contents decide if the sweep begins, resumes,
//! or fills a hidden folder until it can replace earlier tables.

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

/// Permissions of the user for a folder that holds a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Allowed {
    /// True if the sweep in the folder may be resumed.
    pub resume: bool,
    /// True if the tables in the folder may be replaced, once the new ones are complete.
    pub overwrite: bool,
}

impl Allowed {
    fn any(self) -> bool {
        self.resume || self.overwrite
    }
}

/// A folder locked for a sweep.
pub struct Taken {
    claim: Claim,
    allowed: Allowed,
    replaces: bool,
}

/// An earlier sweep in a folder.
pub struct Earlier {
    root: Directory,
    manifest: Manifest,
}

impl Earlier {
    /// The manifest, which lists the complete parts.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The text of the resolved study; empty if its file is absent.
    ///
    /// # Errors
    /// [`Error::Io`] if the file exists and cannot be read.
    pub fn study_text(&self) -> Result<String, Error> {
        Ok(study_text(&self.root)?.unwrap_or_default())
    }

    /// The error for a sweep that differs from the one to resume.
    pub fn refused(&self, differences: Vec<String>) -> Error {
        let dir = self.root.path().to_owned();
        Error::folder(Fault::OtherSweep { dir, differences }, Remedy::OtherFolderOrNotResume)
    }
}

/// Ends an exchange of results that a killed process began in a folder, and checks from its contents that it
/// can take a result.
///
/// # Errors
/// [`Error::Folder`] if it cannot take one; [`Error::Io`] if it cannot be read.
pub fn look(dir: &Path, allowed: Allowed) -> Result<(), Error> {
    end_exchange(dir)?;
    refuse_conflicts(dir, allowed.any())
}

impl Taken {
    /// Locks a folder for the sweep of a study; `text` is the resolved study.
    ///
    /// # Errors
    /// [`Error::Folder`] if the folder cannot be written, another process has locked it, or it holds files that
    /// must not be replaced; [`Error::Io`] if it cannot be read.
    pub fn take(dir: &Path, allowed: Allowed, text: &str) -> Result<Self, Error> {
        let claim = Claim::take(dir)?;
        // The contents may have changed before the folder was locked.
        refuse_conflicts(dir, allowed.any())?;
        let replaces = replaces(claim.dir(), allowed, text)?;
        Ok(Self { claim, allowed, replaces })
    }

    /// True if the sweep fills `.iva-new` and replaces the tables of the folder when it is complete.
    pub fn replaces(&self) -> bool {
        self.replaces
    }

    /// The sweep in the folder, if there is one and resuming it is allowed.
    ///
    /// # Errors
    /// [`Error::Folder`] if its manifest is invalid; [`Error::Io`] if it cannot be read.
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

    /// Resumes a sweep. Returns its folder, with the names of files that differ from the manifest and are to be
    /// computed again; with `elsewhere` no files are checked. Returns `None`, with nothing changed, if `go_on`
    /// returns false.
    ///
    /// # Errors
    /// [`Error::Io`] if a file exists and cannot be read, or something cannot be written.
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

    /// Begins a sweep without complete parts.
    ///
    /// # Errors
    /// [`Error::Folder`] if a file that `iva` did not write has the name of an input; [`Error::Io`] if something
    /// cannot be written.
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

/// True if the sweep of the resolved study `text` has to fill `.iva-new`, since the folder holds tables that
/// stay until it is complete.
///
/// # Errors
/// [`Error::Folder`] if the tables are those of another study; [`Error::Io`] if the folder cannot be read.
fn replaces(dir: &Directory, allowed: Allowed, text: &str) -> Result<bool, Error> {
    let has_tables = holds_tables(dir)?;
    if allowed.overwrite && (has_tables || holds_kept_sweep(dir)?) {
        return Ok(true);
    }
    if allowed.resume && has_tables && dir.kind(Path::new(MANIFEST_FILE))?.is_none() {
        // Tables without a manifest may be incomplete: they stay until the new ones are complete.
        if study_text(dir)?.as_deref() == Some(text) {
            return Ok(true);
        }
        let fault = Fault::OtherTables(dir.path().to_owned());
        return Err(Error::folder(fault, Remedy::OtherFolderOrReplace));
    }
    Ok(false)
}
