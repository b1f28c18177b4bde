//! `backlit sphere-tree`: nested spheres of a closed triangle mesh.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use backlit_formats::{mesh, model_file, sphere_tree_file};
use backlit_sphere_tree::{MAX_LEVELS, MAX_SPHERES, SphereTree, TreeOptions};
use backlit_tracking::body_spheres::{SkinOptions, body_of_skin, body_of_tree};
use clap::Args;

use super::numbers::within;
use super::output;
use super::table::Table;

const AFTER_HELP: &str = "\
The mesh must be closed: the surface of a solid, without holes. The spheres of every level cover the whole \
surface, and each sphere's parent covers every part that the sphere covers. Errors are those of the union of \
a level's spheres, in the mesh's unit: how far it stands out of the mesh (greatest and mean), how far its \
boundary lies inside (voids), and what share of the surface it covers. With N spheres and L levels, level k \
has about N^(k/L).

Examples:
  backlit sphere-tree bunny.ply --out bunny.json
  backlit sphere-tree hand.stl --spheres 64 --levels 2 --out hand.json --json
  backlit sphere-tree statue.glb --spheres 200 --levels 2 --out statue.toml
  backlit sphere-tree person.glb --skinned --spheres 800 --levels 2 --out person.toml";

/// What `backlit sphere-tree` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct SphereTreeArguments {
    /// Mesh: .obj, .ply, .stl, .gltf or .glb
    mesh: PathBuf,
    /// The mesh is skinned (.gltf, .glb): a body with a limb for every bone of its skeleton, each with a tree of its own. --spheres
    /// counts those of all limbs
    #[arg(long)]
    skinned: bool,
    /// Most spheres of the last level [1 to 4096]
    #[arg(long, value_name = "N", default_value_t = 512, value_parser = within(1..=MAX_SPHERES as u32))]
    spheres: u32,
    /// Levels, the coarsest first [1 to 12]
    #[arg(long, value_name = "L", default_value_t = 3, value_parser = within(1..=MAX_LEVELS as u32))]
    levels: u32,
    /// File to write: a tree (.json), or a body of one limb (.toml) for --renderer sphere-tree
    #[arg(long, value_name = "FILE.json|BODY.toml")]
    out: PathBuf,
    /// Print the errors of the levels as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &SphereTreeArguments) -> anyhow::Result<()> {
    output::check_folder_of(&arguments.out)?;
    let ending = arguments.out.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let is_body = match ending.as_deref() {
        Some("json") => false,
        Some("toml") => true,
        _ => bail!("{}: the ending says no format; expected .json or .toml", arguments.out.display()),
    };
    if arguments.skinned {
        return skinned(arguments, is_body);
    }
    let mesh = mesh::read(&arguments.mesh)?;
    let options = TreeOptions { spheres: arguments.spheres as usize, levels: arguments.levels as usize };
    let tree = SphereTree::build(&mesh, &options)?;
    if is_body {
        model_file::write(&arguments.out, &body_of_tree(&tree, &name_of(&arguments.mesh))?)?;
    } else {
        sphere_tree_file::write(&arguments.out, &tree)?;
    }
    if arguments.json {
        return output::print_json(&to_json(&tree));
    }
    let titles = ["level", "spheres", "outside, greatest", "mean", "inside, greatest", "mean", "covered"];
    let mut table = Table::new(titles);
    for (index, level) in tree.levels.iter().enumerate() {
        let error = &level.error;
        let lengths = [error.outside_greatest, error.outside_mean, error.inside_greatest, error.inside_mean];
        let [a, b, c, d] = lengths.map(|length| format!("{length:.4e}"));
        let covered = format!("{:.2} %", 100.0 * error.coverage);
        table.row([(index + 1).to_string(), level.spheres.len().to_string(), a, b, c, d, covered]);
    }
    output::print(&format!("{}wrote {}\n", table.to_text(), arguments.out.display()))
}

fn skinned(arguments: &SphereTreeArguments, is_body: bool) -> anyhow::Result<()> {
    let path = &arguments.mesh;
    if !is_body {
        bail!("{}: a skinned mesh becomes a body; expected --out BODY.toml", arguments.out.display());
    }
    let skin = mesh::read_skin(path)?;
    let options = SkinOptions {
        spheres: arguments.spheres as usize,
        levels: arguments.levels as usize,
        ..SkinOptions::default()
    };
    let body = body_of_skin(&skin, &name_of(path), &options).with_context(|| path.display().to_string())?;
    model_file::write(&arguments.out, &body)?;
    let spheres = body.spheres_by_level();
    if arguments.json {
        let limbs: Vec<&str> = body.limbs().iter().map(|limb| limb.name.as_str()).collect();
        return output::print_json(&serde_json::json!({"limbs": limbs, "spheres": spheres}));
    }
    let counts: Vec<String> = spheres.iter().map(usize::to_string).collect();
    output::print(&format!(
        "{} limbs, {} spheres\nwrote {}\n",
        body.limbs().len(),
        counts.join(" and "),
        arguments.out.display()
    ))
}

fn name_of(mesh: &Path) -> String {
    mesh.file_stem().map_or_else(|| "mesh".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

fn to_json(tree: &SphereTree) -> serde_json::Value {
    let level = |level: &backlit_sphere_tree::Level| {
        let error = &level.error;
        serde_json::json!({
            "spheres": level.spheres.len(),
            "error": {
                "outside_greatest": error.outside_greatest,
                "outside_mean": error.outside_mean,
                "inside_greatest": error.inside_greatest,
                "inside_mean": error.inside_mean,
                "coverage": error.coverage,
            },
        })
    };
    serde_json::json!({"levels": tree.levels.iter().map(level).collect::<Vec<_>>()})
}
