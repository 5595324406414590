//! The operators of a mesh, and S of every body or subdomain.

use std::sync::Arc;
use std::time::Instant;

use faer::Mat;
use rayon::prelude::*;
use steklov_bem_operators::{BemError, EnrichedSteklov, Mesh, Operators, PairCache, Space, Steklov, Subdomain};
use steklov_elastic::Material;

use crate::data::on_mesh::OnMesh;
use crate::data::parts::{Assembled, Piece};
use crate::error::SolveError;
use crate::quantities::needs_tractions;
use crate::solve::solution::Seconds;
use crate::stage::Stage;

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

/// Subdomains that are assembled side by side: the moments of so many lie in memory at once.
const SIDE_BY_SIDE: usize = 16;

/// The matrices S of bodies or subdomains: translates of each other have one.
pub(crate) struct Matrices {
    /// The different ones.
    pub different: Vec<Mat<f64>>,
    /// The number of that of each body.
    pub of: Vec<usize>,
}

impl Matrices {
    /// That of a body.
    pub(crate) fn get(&self, body: usize) -> &Mat<f64> {
        &self.different[self.of[body]]
    }
}

/// S of every body or subdomain, and the other results of its assembly. Bodies, which are large, follow one another, and their
/// matrices for the estimate are made when all is solved. The bits do not depend on the number of threads.
pub(crate) fn assemble(
    data: &OnMesh<'_>,
    pieces: Vec<Piece>,
    estimated: bool,
    cache: &mut PairCache,
    seconds: &mut Seconds,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<(Matrices, Vec<Assembled>), SolveError> {
    let is_cut = pieces.len() > 1 && !data.scene.problem.has_several_bodies();
    let first = match is_cut {
        true => Subdomain::first_translates(&pieces.iter().map(|piece| &piece.part).collect::<Vec<_>>()),
        false => (0..pieces.len()).collect(),
    };
    let different: Vec<usize> = (0..pieces.len()).filter(|&k| first[k] == k).collect();
    let mut made: Vec<(f64, Steklov, Option<EnrichedSteklov>)> = Vec::new();
    for chunk in different.chunks(if is_cut { SIDE_BY_SIDE } else { 1 }) {
        let done = |part: f64| 0.05 + 0.7 * (made.len() as f64 + part * chunk.len() as f64) / different.len() as f64;
        let clock = Instant::now();
        observe(Stage::Progress("assembling V, K, W", done(0.0)))?;
        // the moments of a body are those of its mesh before where elements have not changed
        let mut caches = vec![PairCache::default(); chunk.len()];
        if !is_cut {
            std::mem::swap(&mut caches[0], cache);
        }
        let of_piece = |(&k, cache): (&usize, &mut PairCache)| {
            let Piece { part, material, .. } = &pieces[k];
            operators(&part.mesh, &part.space, material, estimated, cache)
        };
        let assembled: Result<Vec<_>, _> = chunk.par_iter().zip(&mut caches).map(of_piece).collect();
        let assembled = assembled?;
        seconds.assemble += clock.elapsed().as_secs_f64();
        for (number, operators) in chunk.iter().zip(&assembled) {
            for k in (0..pieces.len()).filter(|&k| first[k] == *number) {
                observe(Stage::Operators(k, operators))?;
                if is_cut {
                    observe(Stage::Nodes(k, &pieces[k].part.nodes))?;
                }
            }
        }

        let clock = Instant::now();
        observe(Stage::Progress("Steklov-Poincaré matrix", done(0.35)))?;
        let of_operators = |(operators, &k): (Operators, &usize)| {
            Ok::<_, BemError>((operators.length, Steklov::new(operators, data.scene.domain(pieces[k].body))?))
        };
        let factorised: Result<Vec<(f64, Steklov)>, _> =
            assembled.into_par_iter().zip(chunk).map(of_operators).collect();
        let factorised = factorised?;
        seconds.factorise += clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let enriched = |(&k, (cache, (length, steklov))): (&usize, (&mut PairCache, &(f64, Steklov)))| {
            let Piece { part, material, .. } = &pieces[k];
            let (mesh, space, tractions) = (&part.mesh, &part.space, needs_tractions(data.scene));
            let of = || EnrichedSteklov::new(mesh, space, material, *length, &steklov.traction, cache, tractions);
            (estimated && is_cut).then(of).transpose()
        };
        let enriched: Result<Vec<_>, _> =
            chunk.par_iter().zip(caches.par_iter_mut().zip(&factorised)).map(enriched).collect();
        if !is_cut {
            std::mem::swap(&mut caches[0], cache);
        }
        made.extend(
            factorised.into_iter().zip(enriched?).map(|((length, steklov), enriched)| (length, steklov, enriched)),
        );
        seconds.enrich += clock.elapsed().as_secs_f64();
    }
    let of: Vec<usize> = first.iter().map(|k| different.binary_search(k).expect("one of the different")).collect();
    let (mut matrices, mut shared) = (Vec::new(), Vec::new());
    for (length, Steklov { matrix, traction }, enriched) in made {
        matrices.push(matrix);
        shared.push((length, Arc::new(traction), enriched.map(Arc::new)));
    }
    let body = |(piece, &number): (Piece, &usize)| {
        let (length, traction_map, enriched) = shared[number].clone();
        Assembled { piece, length, traction_map, enriched, modulus: 1.0, turning: Vec::new(), carried: None }
    };
    let bodies = pieces.into_iter().zip(&of).map(body).collect();
    Ok((Matrices { different: matrices, of }, bodies))
}
