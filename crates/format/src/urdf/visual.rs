//! The `<visual>` meshes of a URDF: what the links look like, each in the frame of its row. The files stay where they
//! are. A mesh that cannot be drawn is noted by its name, and the link is drawn by its collision mesh or illustrated.

use super::arm::Arm;
use super::bodies::{attached_to, row_from_links};
use super::collision::LinkShapes;
use super::meshes::{found, free_name, is_read, unit_of};
use super::read::{Geometry, Urdf};
use super::xml::{one_line, quoted};
use crate::mesh::{MeshUnit, read_mesh};
use std::path::PathBuf;
use std::sync::Arc;
use stead_cell::{Attachment, Solid, Visual};
use stead_disk::files;
use stead_model::robot::Pose;

/// What a link looks like, and the mesh file that it is made of, with its unit.
#[derive(Debug, Clone)]
pub struct LinkVisual {
    /// What is drawn, in the frame of the row that its link moves with.
    pub visual: Visual,
    /// The mesh file.
    pub file: PathBuf,
    /// Its unit.
    pub unit: MeshUnit,
}

/// What stands with the base and the six links behind the moving joints look like, each with all that is fixed to it,
/// and notes on what is not drawn.
pub(super) fn link_visuals(arm: &Arm<'_>, shapes: &LinkShapes) -> (Vec<LinkVisual>, Vec<String>) {
    let stand = &arm.stand;
    let base_from_cell = stand.mount.map_or_else(Pose::identity, |mount| mount.inverse());
    let mut read = Reading { urdf: arm.urdf, base_from_cell, visuals: Vec::new(), notes: Vec::new() };
    read.links(stand.link, &stand.base_from_link, Attachment::Base, shapes);
    for ((link, row_from_link), number) in row_from_links(arm).into_iter().zip(1..) {
        read.links(link, &row_from_link, Attachment::Link(number), shapes);
    }
    (read.visuals, read.notes)
}

struct Reading<'a> {
    urdf: &'a Urdf,
    /// Shapes on the base are stated in the cell.
    base_from_cell: Pose<f64>,
    visuals: Vec<LinkVisual>,
    notes: Vec<String>,
}

impl Reading<'_> {
    /// What a link and all that is fixed to it look like.
    fn links(&mut self, link: usize, frame_from_link: &Pose<f64>, attached: Attachment, shapes: &LinkShapes) {
        let (visuals, notes) = (self.visuals.len(), self.notes.len());
        for (link, pose) in attached_to(self.urdf, link) {
            for visual in &self.urdf.links[link].visuals {
                let read = visual.as_ref().map_err(|error| one_line(&error.to_string())).and_then(|visual| {
                    let (mesh, file, unit) = self.mesh(&visual.geometry)?;
                    let pose = frame_from_link.then(&pose).then(&visual.origin);
                    let visual = Visual { name: self.name(link), attached, mesh, pose, color: visual.color };
                    Ok(LinkVisual { visual, file, unit })
                });
                match read {
                    Ok(visual) => self.visuals.push(visual),
                    Err(problem) => {
                        let link = quoted(&self.urdf.links[link].name);
                        self.notes.push(format!("a <visual> of link {link} is not drawn: {problem}"));
                    }
                }
            }
        }
        if visuals < self.visuals.len() || notes == self.notes.len() {
            return;
        }
        for of in shapes.shapes.iter().filter(|of| of.shape.attached == attached) {
            let (Solid::Hull(mesh) | Solid::Mesh(mesh), Some((file, unit))) = (&of.shape.solid, &of.file) else {
                continue;
            };
            let pose = match attached {
                Attachment::Base => self.base_from_cell.then(&of.shape.pose),
                _ => of.shape.pose,
            };
            let visual = Visual { name: self.name(link), attached, mesh: Arc::clone(mesh), pose, color: None };
            self.notes.push(format!("link {} is drawn by its collision mesh", quoted(&self.urdf.links[link].name)));
            self.visuals.push(LinkVisual { visual, file: file.clone(), unit: *unit });
        }
    }

    /// The mesh of a form, its file and unit, or why there is none.
    fn mesh(&self, geometry: &Geometry) -> Result<(Arc<stead_cell::TriangleMesh>, PathBuf, MeshUnit), String> {
        let Geometry::Mesh { file, scale } = geometry else {
            return Err("it is no mesh but a box, a cylinder or a sphere".to_owned());
        };
        let name = quoted(file.rsplit(['/', '\\']).next().unwrap_or(file));
        if !is_read(file) {
            return Err(format!("mesh {name} is none of STL, OBJ and DAE"));
        }
        if scale.iter().any(|factor| *factor < 0.0) {
            return Err(format!("mesh {name} is mirrored by a scale of {:?}", scale.as_slice()));
        }
        let unit = unit_of(scale)
            .ok_or_else(|| format!("mesh {name} has a scale of {:?}: 1 and 0.001 are drawn", scale.as_slice()))?;
        let path = found(self.urdf, file).ok_or_else(|| format!("mesh {name} is not found"))?;
        let bytes = files::read(&path).map_err(|error| format!("mesh {name} cannot be read: {error}"))?;
        let mesh = read_mesh(&path, &bytes, unit).map_err(|error| one_line(&error.to_string()))?;
        Ok((Arc::new(mesh), path, unit))
    }

    /// A name for what a link looks like, that no other has.
    fn name(&self, link: usize) -> String {
        let plain = format!("{} visual", one_line(&self.urdf.links[link].name).replace('"', "'"));
        free_name(plain, |name| self.visuals.iter().all(|known| known.visual.name != name))
    }
}
