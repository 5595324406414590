//! [`Persist`] for the types of `steklov-elastic`.

use hdf5::Group;
use steklov_elastic::{Material, Plane};

use crate::array::{load_number, save_number};
use crate::error::{IoError, invalid, mismatch};
use crate::persist::Persist;
use crate::text::{load_text, save_text};

pub(crate) fn save_plane(at: &Group, plane: Plane) -> Result<(), IoError> {
    let word = match plane {
        Plane::Strain => "strain",
        Plane::Stress => "stress",
    };
    save_text(at, "plane", word, "plane strain or plane stress")
}

pub(crate) fn load_plane(at: &Group) -> Result<Plane, IoError> {
    match load_text(at, "plane")?.as_str() {
        "strain" => Ok(Plane::Strain),
        "stress" => Ok(Plane::Stress),
        other => Err(mismatch(at, "plane", "strain or stress", other)),
    }
}

impl Persist for Material {
    const KIND: &'static str = "isotropic elastic material";
    const VERSION: u32 = 1;

    fn write(&self, at: &Group) -> Result<(), IoError> {
        save_number(at, "young", self.young, "stress", "Young's modulus E")?;
        save_number(at, "poisson", self.poisson, "1", "Poisson's ratio")?;
        save_plane(at, self.plane)
    }

    fn read(at: &Group) -> Result<Self, IoError> {
        let plane = load_plane(at)?;
        Material::new(load_number(at, "young")?, load_number(at, "poisson")?, plane).map_err(|e| invalid(at, "", e))
    }
}
