//! Checks a mesh by itself: whether it is a closed, orientable 2-manifold. Shares no code with the mesher.

use rustc_hash::FxHashMap as HashMap;

use glam::{DVec3, Vec3};

/// The properties of a sound mesh.
#[derive(Debug)]
pub struct Sound {
    /// Connected surfaces.
    pub surfaces: usize,
    /// The sum of their genera, that is, of their handles.
    pub handles: i64,
    /// Signed volume, positive if the triangles face outwards.
    pub volume: f64,
    /// The smallest area of a triangle.
    pub least_area: f64,
}

/// Checks a mesh. The error names the first fault.
pub fn check(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<Sound, String> {
    if let Some(bad) = positions.iter().find(|position| !position.is_finite()) {
        return Err(format!("a vertex at {bad}"));
    }
    let mut edges: HashMap<(u32, u32), usize> = HashMap::default();
    for (number, triangle) in triangles.iter().enumerate() {
        if triangle.iter().any(|&vertex| vertex as usize >= positions.len()) {
            return Err(format!("triangle {triangle:?} of {} vertices", positions.len()));
        }
        for i in 0..3 {
            let (from, to) = (triangle[i], triangle[(i + 1) % 3]);
            if from == to {
                return Err(format!("triangle {triangle:?} has a corner twice"));
            }
            if edges.insert((from, to), number).is_some() {
                let at = [from, to].map(|vertex| positions[vertex as usize]);
                return Err(format!("two triangles have the edge {from} to {to} at {at:?}"));
            }
        }
    }
    if let Some((from, to)) = edges.keys().find(|(from, to)| !edges.contains_key(&(*to, *from))) {
        let at = [from, to].map(|vertex| positions[*vertex as usize]);
        return Err(format!("the edge {from} to {to} at {at:?} is open"));
    }
    check_fans(positions, triangles, &edges)?;
    let (surfaces, handles) = topology(positions.len(), triangles)?;
    let corner = |vertex: u32| positions[vertex as usize].as_dvec3();
    let (mut volume, mut least_area) = (0.0, f64::INFINITY);
    for &[a, b, c] in triangles {
        let [a, b, c]: [DVec3; 3] = [corner(a), corner(b), corner(c)];
        volume += a.dot(b.cross(c)) / 6.0;
        least_area = f64::min(least_area, 0.5 * (b - a).cross(c - a).length());
    }
    Ok(Sound { surfaces, handles, volume, least_area })
}

/// Checks that the triangles around each vertex form one closed fan.
fn check_fans(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    edges: &HashMap<(u32, u32), usize>,
) -> Result<(), String> {
    let mut degree = vec![0usize; positions.len()];
    let mut any = vec![usize::MAX; positions.len()];
    for (number, triangle) in triangles.iter().enumerate() {
        for &vertex in triangle {
            degree[vertex as usize] += 1;
            any[vertex as usize] = number;
        }
    }
    for vertex in 0..positions.len() as u32 {
        let first = any[vertex as usize];
        if first == usize::MAX {
            return Err(format!("vertex {vertex} has no triangle"));
        }
        let (mut at, mut turned) = (first, 0);
        loop {
            let triangle = triangles[at];
            let place = triangle.iter().position(|&v| v == vertex).unwrap();
            let before = triangle[(place + 2) % 3];
            turned += 1;
            at = edges[&(vertex, before)];
            if at == first {
                break;
            }
        }
        if turned != degree[vertex as usize] {
            let position = positions[vertex as usize];
            return Err(format!("vertex {vertex} at {position} has several fans"));
        }
    }
    Ok(())
}

/// Returns the number of surfaces, and of their handles together.
fn topology(vertices: usize, triangles: &[[u32; 3]]) -> Result<(usize, i64), String> {
    let mut parent: Vec<usize> = (0..vertices).collect();
    fn root(parent: &mut [usize], mut at: usize) -> usize {
        while parent[at] != at {
            parent[at] = parent[parent[at]];
            at = parent[at];
        }
        at
    }
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| root(&mut parent, vertex as usize));
        parent[b] = a;
        let (a, c) = (root(&mut parent, a), root(&mut parent, c));
        parent[c] = a;
    }
    let mut euler: HashMap<usize, i64> = HashMap::default();
    for vertex in 0..vertices {
        *euler.entry(root(&mut parent, vertex)).or_default() += 1;
    }
    // A closed surface has three edges for each two triangles.
    let mut faces: HashMap<usize, i64> = HashMap::default();
    for triangle in triangles {
        *faces.entry(root(&mut parent, triangle[0] as usize)).or_default() += 1;
    }
    let mut handles = 0;
    for (surface, vertices) in &euler {
        let faces = faces.get(surface).copied().unwrap_or(0);
        let euler = vertices - faces / 2;
        if faces % 2 != 0 || euler > 2 || euler % 2 != 0 {
            return Err(format!("a surface with Euler number {euler} and {faces} triangles"));
        }
        handles += (2 - euler) / 2;
    }
    Ok((euler.len(), handles))
}

/// Merges vertices at the same position, as programs do that read files without shared vertices.
pub(crate) fn welded(positions: &[Vec3], triangles: &[[u32; 3]]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut numbers: HashMap<[u32; 3], u32> = HashMap::default();
    let mut kept = Vec::new();
    let number: Vec<u32> = positions
        .iter()
        .map(|position| {
            let key = position.to_array().map(|coordinate| (coordinate + 0.0).to_bits());
            *numbers.entry(key).or_insert_with(|| {
                kept.push(*position);
                kept.len() as u32 - 1
            })
        })
        .collect();
    let triangles = triangles.iter().map(|t| t.map(|vertex| number[vertex as usize])).collect();
    (kept, triangles)
}

#[test]
fn the_check_finds_each_kind_of_fault() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    let solid = |[a, b, c, d]: [u32; 4]| [[a, c, b], [a, b, d], [b, c, d], [c, a, d]];
    let one = solid([0, 1, 2, 3]);
    let sound = check(&corners[..4], &one).unwrap();
    assert_eq!((sound.surfaces, sound.handles), (1, 0));
    assert!((sound.volume - 1.0 / 6.0).abs() < 1e-9);
    assert!(check(&corners[..4], &one[..3]).unwrap_err().contains("open"));
    let twice = [one, one].concat();
    assert!(check(&corners[..4], &twice).unwrap_err().contains("two triangles"));
    // Two solids that share a corner, which then has two fans.
    let other = solid([0, 4, 5, 6]).map(|[a, b, c]| [a, c, b]);
    let touching = [one, other].concat();
    assert!(check(&corners, &touching).unwrap_err().contains("several fans"));
    assert!(check(&corners[..5], &one).unwrap_err().contains("no triangle"));
    assert!(check(&corners[..4], &[[0, 0, 1]]).unwrap_err().contains("twice"));
}
