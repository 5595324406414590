//! The operators of a mesh.

use steklov_bem_operators::{BemError, Mesh, Operators, PairCache, Space};
use steklov_elastic::Material;

/// V, K, W of a mesh; `estimated`: keeps in `cache` the data that an estimate needs besides.
pub(crate) fn operators(
    mesh: &Mesh,
    space: &Space,
    material: &Material,
    estimated: bool,
    cache: &mut PairCache,
) -> Result<Operators, BemError> {
    match estimated {
        true => Operators::to_enrich(mesh, space, material, None, cache),
        false => Operators::assemble(mesh, space, material, None),
    }
}
