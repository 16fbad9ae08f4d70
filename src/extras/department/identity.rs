//! Membership of a department: certificates issued by one machine.
//!
//! The machine that creates the department keeps its key, and issues a certificate with a key to each rig and each
//! watcher, in one file that is carried to them. All files are readable only by their owner.

use std::{
    fs,
    path::{Path, PathBuf},
};

use nima_files::write_private;
use rcgen::{
    BasicConstraints, CertificateParams, DnType, ExtendedKeyUsagePurpose, IsCa, Issuer, KeyPair, KeyUsagePurpose,
};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::{DepartmentError, keys::checked_name};

const AUTHORITY: &str = "department.toml";
const OWN: &str = "own.toml";

/// Role of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MachineRole {
    /// Publishes its own state, and may watch others.
    Rig,
    /// May only watch.
    Watcher,
}

impl MachineRole {
    pub const fn word(self) -> &'static str {
        match self {
            Self::Rig => "rig",
            Self::Watcher => "watcher",
        }
    }
}

/// Issues the certificates of a department.
#[derive(Clone, Serialize, Deserialize)]
pub struct Authority {
    pub department: String,
    certificate: String,
    key: String,
}

/// Identity of a machine in its department.
#[derive(Clone, Serialize, Deserialize)]
pub struct MachineIdentity {
    pub department: String,
    pub name: String,
    pub role: MachineRole,
    pub(crate) authority: String,
    pub(crate) certificate: String,
    pub(crate) key: String,
}

fn params_of_authority(department: &str) -> Result<CertificateParams, rcgen::Error> {
    let mut params = CertificateParams::new(Vec::new())?;
    params.distinguished_name.push(DnType::CommonName, format!("NIMA department {department}"));
    params.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
    params.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
    Ok(params)
}

impl From<rcgen::Error> for DepartmentError {
    fn from(error: rcgen::Error) -> Self {
        Self::Certificate(error.to_string())
    }
}

impl Authority {
    /// Creates a department in this folder.
    ///
    /// # Errors
    /// [`DepartmentError`] if the name cannot be used, a department exists already, or the file cannot be written.
    pub fn create(folder: &Path, department: &str) -> Result<Self, DepartmentError> {
        let department = checked_name(department)?;
        let key = KeyPair::generate()?;
        let certificate = params_of_authority(&department)?.self_signed(&key)?;
        let authority = Self { department, certificate: certificate.pem(), key: key.serialize_pem() };
        write(&folder.join(AUTHORITY), &authority)?;
        Ok(authority)
    }

    /// Loads the department that was created in this folder.
    ///
    /// # Errors
    /// [`DepartmentError`] if there is none.
    pub fn load(folder: &Path) -> Result<Self, DepartmentError> {
        read(
            &folder.join(AUTHORITY),
            "create a department with `nima department create NAME`, or go to the machine that did",
        )
    }

    /// Issues a certificate for a machine and writes it into a new file, which must be carried there.
    ///
    /// # Errors
    /// [`DepartmentError`] if the name cannot be used, or the file cannot be written.
    pub fn issue(&self, name: &str, role: MachineRole, to: &Path) -> Result<MachineIdentity, DepartmentError> {
        let name = checked_name(name)?;
        let params = params_of_authority(&self.department)?;
        let issuer = Issuer::new(params, KeyPair::from_pem(&self.key)?);
        let key = KeyPair::generate()?;
        // The name is not checked, because a rig is found by its address, which is arbitrary.
        let mut params = CertificateParams::new(vec![name.clone()])?;
        params.distinguished_name.push(DnType::CommonName, name.clone());
        params.key_usages = vec![KeyUsagePurpose::DigitalSignature];
        params.extended_key_usages = vec![ExtendedKeyUsagePurpose::ClientAuth];
        if role == MachineRole::Rig {
            // Required so that clients accept its response as a rig's.
            params.extended_key_usages.push(ExtendedKeyUsagePurpose::ServerAuth);
        }
        let certificate = params.signed_by(&key, &issuer)?;
        let certificate = certificate.pem();
        let key = key.serialize_pem();
        let department = self.department.clone();
        let authority = self.certificate.clone();
        let identity = MachineIdentity { department, name, role, authority, certificate, key };
        write(to, &identity)?;
        Ok(identity)
    }
}

impl MachineIdentity {
    /// Installs the file that was issued for this machine into its folder.
    ///
    /// # Errors
    /// [`DepartmentError`] if it is not such a file, or this machine belongs to a department already.
    pub fn join(folder: &Path, issued: &Path) -> Result<Self, DepartmentError> {
        let identity: Self = read(issued, "name the file that `nima department issue` wrote")?;
        checked_name(&identity.name)?;
        KeyPair::from_pem(&identity.key).map_err(|error| not_one(issued, &error))?;
        write(&folder.join(OWN), &identity)?;
        Ok(identity)
    }

    /// Loads the identity of this machine.
    ///
    /// # Errors
    /// [`DepartmentError`] if it has not joined a department.
    pub fn load(folder: &Path) -> Result<Self, DepartmentError> {
        read(&folder.join(OWN), "let the department issue a certificate and use `nima department join FILE`")
    }

    /// Returns this machine, if it may be shared.
    ///
    /// # Errors
    /// [`DepartmentError::Role`] if it may only watch.
    pub fn as_rig(&self) -> Result<&Self, DepartmentError> {
        match self.role {
            MachineRole::Rig => Ok(self),
            MachineRole::Watcher => {
                Err(DepartmentError::Role { is: self.role.word(), needed: MachineRole::Rig.word() })
            }
        }
    }
}

fn not_one(path: &Path, error: &dyn std::fmt::Display) -> DepartmentError {
    DepartmentError::NotOne { path: path.to_owned(), why: error.to_string() }
}

fn read<T: DeserializeOwned>(path: &Path, cure: &'static str) -> Result<T, DepartmentError> {
    match fs::read_to_string(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            Err(DepartmentError::Missing { path: path.to_owned(), cure })
        }
        Err(error) if error.kind() == std::io::ErrorKind::InvalidData => Err(not_one(path, &error)),
        read => {
            let text = read.map_err(DepartmentError::of_file(path))?;
            nima_files::from_toml(&text).map_err(|misfit| not_one(path, &misfit.message()))
        }
    }
}

/// Writes a new file that only its owner can read.
fn write(path: &Path, value: &impl Serialize) -> Result<(), DepartmentError> {
    if path.exists() {
        return Err(DepartmentError::Exists(path.to_owned()));
    }
    let text = toml::to_string(value).map_err(|error| DepartmentError::Certificate(error.to_string()))?;
    let folder: PathBuf = path.parent().map(Path::to_owned).unwrap_or_default();
    let write = || {
        if !folder.as_os_str().is_empty() {
            fs::create_dir_all(&folder)?;
        }
        write_private(path, &text)
    };
    write().map_err(DepartmentError::of_file(path))
}
