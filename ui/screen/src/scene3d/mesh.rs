//! Triangle meshes: tubes, spheres, rings and surfaces with smooth normals. Independent of the GPU.

use egui::Color32;
use nalgebra::{UnitQuaternion, Vector3};

/// Shading of a surface; the fragment shader selects it by this number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Material {
    /// Plastic: diffuse light, weak highlight.
    Matte = 0,
    /// Wet and mottled, with a 5 mm grid that shows the deformation; receives the instrument's shadow.
    Tissue = 1,
    /// Steel: strong highlight.
    Metal = 2,
    /// Constant colour independent of light, for information that is not a physical object.
    Plain = 3,
}

/// One vertex in the GPU's format: 28 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct MeshVertex {
    /// Workspace position, m.
    pub position: [f32; 3],
    /// Outward normal, unit length.
    pub normal: [f32; 3],
    /// sRGB colour; the last byte is the [`Material`].
    pub colour: [u8; 4],
}

#[derive(Clone, Copy, Debug)]
pub struct Paint(pub Color32, pub Material);

#[derive(Clone, Debug, Default)]
pub struct Mesh {
    pub vertices: Vec<MeshVertex>,
    /// Indices of the vertices, three per triangle.
    pub indices: Vec<u32>,
}

impl Mesh {
    /// Adds a vertex; returns its index.
    pub fn vertex(&mut self, position: Vector3<f32>, normal: Vector3<f32>, paint: Paint) -> u32 {
        let [r, g, b, _] = paint.0.to_array();
        self.vertices.push(MeshVertex {
            position: position.into(),
            normal: normal.into(),
            colour: [r, g, b, paint.1 as u8],
        });
        self.vertices.len() as u32 - 1
    }

    /// Returns the indices of all triangles, three per triangle, by [`Material`], in the order in which they were
    /// added.
    pub fn corners_by_material(&self) -> [Vec<u32>; 4] {
        let mut corners: [Vec<u32>; 4] = Default::default();
        for triangle in self.indices.chunks_exact(3) {
            let material = self.vertices.get(triangle[0] as usize).map_or(0, |vertex| usize::from(vertex.colour[3]));
            if let Some(corners) = corners.get_mut(material) {
                corners.extend_from_slice(triangle);
            }
        }
        corners
    }

    /// Adds the triangles of `rows` by `columns` cells, whose vertices were added row by row starting at index `first`.
    pub fn sheet(&mut self, first: u32, rows: u32, columns: u32) {
        let stride = columns + 1;
        for row in 0..rows {
            for column in 0..columns {
                let a = first + row * stride + column;
                let b = a + 1;
                let c = a + stride;
                let d = a + stride + 1;
                self.indices.extend([a, b, d, a, d, c]);
            }
        }
    }

    /// Adds a tube or cone from one radius to another, closed at both ends.
    pub fn tube(&mut self, ends: [Vector3<f32>; 2], radii: [f32; 2], sides: u32, paint: Paint) {
        let axis = ends[1] - ends[0];
        let length = axis.norm();
        let Some(along) = axis.try_normalize(1e-7) else { return };
        let (u, v) = across(&along);
        // The normal of a cone is tilted by the slope of its side.
        let lean = along * ((radii[0] - radii[1]) / length);
        let first = self.vertices.len() as u32;
        for (end, radius) in ends.iter().zip(radii) {
            for side in 0..=sides {
                let out = around(&u, &v, side, sides);
                self.vertex(end + out * radius, (out + lean).normalize(), paint);
            }
        }
        self.sheet(first, 1, sides);
        for (end, radius, facing) in [(ends[0], radii[0], -along), (ends[1], radii[1], along)] {
            if radius > 1e-6 {
                self.disc(end, facing, radius, sides, paint);
            }
        }
    }

    /// Adds a tube of even thickness along points, open at both ends.
    pub fn pipe(&mut self, points: &[Vector3<f32>], radius: f32, sides: u32, paint: Paint) {
        let way = |i: usize| points[(i + 1).min(points.len() - 1)] - points[i.saturating_sub(1)];
        if points.len() < 2 || (0..points.len()).any(|i| way(i).norm() < 1e-7) {
            return;
        }
        let first = self.vertices.len() as u32;
        let (mut u, _) = across(&way(0).normalize());
        for (i, point) in points.iter().enumerate() {
            // Turn the frame as little as possible, so that the tube does not twist.
            let along = way(i).normalize();
            u = (u - along * along.dot(&u)).try_normalize(1e-6).unwrap_or_else(|| across(&along).0);
            let v = along.cross(&u);
            for side in 0..=sides {
                let out = around(&u, &v, side, sides);
                self.vertex(point + out * radius, out, paint);
            }
        }
        self.sheet(first, points.len() as u32 - 1, sides);
    }

    fn disc(&mut self, centre: Vector3<f32>, facing: Vector3<f32>, radius: f32, sides: u32, paint: Paint) {
        let (u, v) = across(&facing);
        let middle = self.vertex(centre, facing, paint);
        for side in 0..=sides {
            self.vertex(centre + around(&u, &v, side, sides) * radius, facing, paint);
        }
        for side in 1..=sides {
            self.indices.extend([middle, middle + side, middle + side + 1]);
        }
    }

    pub fn sphere(&mut self, centre: Vector3<f32>, radius: f32, rings: u32, paint: Paint) {
        let first = self.vertices.len() as u32;
        let sides = 2 * rings;
        for ring in 0..=rings {
            let (sin, cos) = (std::f32::consts::PI * ring as f32 / rings as f32).sin_cos();
            for side in 0..=sides {
                let out = around(&Vector3::x(), &Vector3::y(), side, sides) * sin + Vector3::z() * cos;
                self.vertex(centre + out * radius, out, paint);
            }
        }
        self.sheet(first, rings, sides);
    }

    /// Returns a horizontal ring; each of its points is raised by `lift(x, y)`, so that it follows a surface.
    pub fn ring(
        &mut self,
        centre: Vector3<f32>,
        [radius, thickness]: [f32; 2],
        lift: impl Fn(f32, f32) -> f32,
        paint: Paint,
    ) {
        // Fewer corners would be visible in the outline.
        const AROUND: u32 = 28;
        const ACROSS: u32 = 10;
        let first = self.vertices.len() as u32;
        for step in 0..=AROUND {
            let out = around(&Vector3::x(), &Vector3::y(), step, AROUND);
            let core = centre + out * radius;
            let core = core + Vector3::z() * lift(core.x, core.y);
            for side in 0..=ACROSS {
                let normal = around(&out, &Vector3::z(), side, ACROSS);
                self.vertex(core + normal * thickness, normal, paint);
            }
        }
        self.sheet(first, AROUND, ACROSS);
    }

    /// Adds a torus about its own z axis, rotated: distance from its centre to the centre of its tube, and radius of
    /// the tube.
    pub fn torus(&mut self, centre: Vector3<f32>, turn: &UnitQuaternion<f32>, [major, tube]: [f32; 2], paint: Paint) {
        // Fewer corners would be visible in the outline.
        const AROUND: u32 = 28;
        const ACROSS: u32 = 12;
        let first = self.vertices.len() as u32;
        for step in 0..=AROUND {
            let out = around(&Vector3::x(), &Vector3::y(), step, AROUND);
            for side in 0..=ACROSS {
                let normal = around(&out, &Vector3::z(), side, ACROSS);
                self.vertex(centre + turn * (out * major + normal * tube), turn * normal, paint);
            }
        }
        self.sheet(first, AROUND, ACROSS);
    }

    /// Adds a box from its lowest to its highest corner.
    pub fn cuboid(&mut self, low: Vector3<f32>, high: Vector3<f32>, paint: Paint) {
        let centre = (low + high) * 0.5;
        let half = (high - low) * 0.5;
        for axis in 0..3 {
            let a = (axis + 1) % 3;
            let b = (axis + 2) % 3;
            for sign in [-1.0, 1.0] {
                let mut normal = Vector3::zeros();
                normal[axis] = sign;
                let first = self.vertices.len() as u32;
                for (i, j) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
                    let mut corner = centre;
                    corner[axis] += sign * half[axis];
                    corner[a] += i * half[a];
                    corner[b] += j * half[b];
                    self.vertex(corner, normal, paint);
                }
                self.sheet(first, 1, 1);
            }
        }
    }

    /// Returns a band along points that faces the eye; `width` gives its width (m) at each point.
    pub fn ribbon(
        &mut self,
        points: &[Vector3<f32>],
        eye_m: &Vector3<f32>,
        width: impl Fn(usize) -> f32,
        paint: Paint,
    ) {
        if points.len() < 2 {
            return;
        }
        let first = self.vertices.len() as u32;
        for (i, point) in points.iter().enumerate() {
            let way = points[(i + 1).min(points.len() - 1)] - points[i.saturating_sub(1)];
            let to_eye = eye_m - point;
            let side = way.cross(&to_eye).try_normalize(1e-9).unwrap_or_else(Vector3::x) * (0.5 * width(i));
            let normal = to_eye.try_normalize(1e-9).unwrap_or_else(Vector3::z);
            self.vertex(point - side, normal, paint);
            self.vertex(point + side, normal, paint);
        }
        self.sheet(first, points.len() as u32 - 1, 1);
    }
}

/// Returns two unit vectors that make a right-handed frame with `along`.
fn across(along: &Vector3<f32>) -> (Vector3<f32>, Vector3<f32>) {
    let helper = if along.z.abs() < 0.9 { Vector3::z() } else { Vector3::x() };
    let u = helper.cross(along).try_normalize(1e-9).unwrap_or_else(Vector3::x);
    (u, along.cross(&u))
}

/// Returns the direction after `step` of `steps` parts of a full rotation from `u` towards `v`.
fn around(u: &Vector3<f32>, v: &Vector3<f32>, step: u32, steps: u32) -> Vector3<f32> {
    let (sin, cos) = (std::f32::consts::TAU * step as f32 / steps as f32).sin_cos();
    u * cos + v * sin
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAINT: Paint = Paint(Color32::WHITE, Material::Matte);

    fn sound(mesh: &Mesh) {
        assert!(!mesh.indices.is_empty() && mesh.indices.len().is_multiple_of(3));
        assert!(mesh.indices.iter().all(|&i| (i as usize) < mesh.vertices.len()));
        for vertex in &mesh.vertices {
            let normal = Vector3::from(vertex.normal);
            assert!((normal.norm() - 1.0).abs() < 1e-4, "{normal}");
            assert!(vertex.position.iter().all(|x| x.is_finite()));
        }
    }

    #[test]
    fn every_shape_is_sound() {
        let mut mesh = Mesh::default();
        mesh.tube([Vector3::zeros(), Vector3::new(0.0, 0.1, 0.3)], [0.01, 0.0], 12, PAINT);
        mesh.sphere(Vector3::x(), 0.5, 8, PAINT);
        mesh.ring(Vector3::zeros(), [0.01, 0.001], |x, y| x * y, PAINT);
        mesh.torus(Vector3::x(), &UnitQuaternion::from_euler_angles(1.0, 0.3, 0.0), [0.01, 0.002], PAINT);
        mesh.cuboid(-Vector3::repeat(1.0), Vector3::repeat(2.0), PAINT);
        mesh.pipe(&[Vector3::zeros(), Vector3::x(), Vector3::new(1.0, 1.0, 0.2), Vector3::z()], 0.1, 8, PAINT);
        mesh.ribbon(&[Vector3::zeros(), Vector3::x(), Vector3::x()], &Vector3::z(), |_| 0.01, PAINT);
        sound(&mesh);
    }

    #[test]
    fn nothing_long_is_left_out_without_a_nan() {
        let mut mesh = Mesh::default();
        mesh.tube([Vector3::x(), Vector3::x()], [0.01, 0.01], 12, PAINT);
        mesh.ribbon(&[Vector3::x()], &Vector3::z(), |_| 0.01, PAINT);
        mesh.pipe(&[Vector3::x(), Vector3::x()], 0.1, 8, PAINT);
        assert!(mesh.vertices.is_empty() && mesh.indices.is_empty());
    }

    #[test]
    fn every_triangle_is_drawn_once_with_its_own_material() {
        let mut mesh = Mesh::default();
        for material in [Material::Tissue, Material::Plain, Material::Metal, Material::Matte, Material::Plain] {
            mesh.sphere(Vector3::x(), 0.5, 4, Paint(Color32::WHITE, material));
        }
        let corners = mesh.corners_by_material();
        let counts = corners.each_ref().map(Vec::len);
        assert_eq!(counts.iter().sum::<usize>(), mesh.indices.len());
        assert_eq!(counts[Material::Plain as usize], 2 * counts[Material::Metal as usize]);
        let metal = &corners[Material::Metal as usize];
        assert!(metal.iter().all(|&i| mesh.vertices[i as usize].colour[3] == Material::Metal as u8));
    }

    #[test]
    fn the_gpu_reads_28_bytes_a_corner() {
        assert_eq!(size_of::<MeshVertex>(), 28);
    }
}
