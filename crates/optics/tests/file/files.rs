//! Files of rays that sources name.

use rayweave_optics::file::OpticalScene;
use rayweave_scene::Diagnostics;

/// A model in a folder of its own with other files.
fn read_in_folder(name: &str, text: &str, files: &[(&str, &[u8])]) -> Result<OpticalScene, Diagnostics> {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("optics-file-{name}"));
    std::fs::create_dir_all(&folder).unwrap();
    files.iter().for_each(|(file, bytes)| std::fs::write(folder.join(file), bytes).unwrap());
    let model = folder.join("model.toml");
    std::fs::write(&model, format!("rayweave = 1\n{text}")).unwrap();
    let (document, scene) = rayweave_scene::load(&model, &Vec::<(String, String)>::new())?;
    rayweave_optics::file::optics_of(&document, &scene)
}

#[test]
fn rays_from_files() {
    let light = b"power,ox,oy,oz,dx,dy,dz,wavelength_nm\n3,0,0,0,0,0,2,486.1\n1,1,0,0,0,1,0,656.3\n";
    let plain = b"ox,oy,oz,dx,dy,dz\n0,0,0,0,0,1\n0,5,0,0,0,1\n";
    let text = "[optics]
        [[optics.source]]
        rays = { file = 'light.csv' }
        [[optics.source]]
        rays = { file = 'light.csv' }
        power = 8
        transform = [{ translate = [0, 0, 7] }]
        [[optics.source]]
        rays = { file = 'plain.csv' }
        wavelength_nm = 500";
    let files: [(&str, &[u8]); 2] = [("light.csv", light), ("plain.csv", plain)];
    let rays = read_in_folder("rays", text, &files).unwrap().sources.rays(0..u64::MAX);
    assert_eq!(rays.power, [3.0, 1.0, 6.0, 2.0, 0.5, 0.5]);
    assert_eq!(rays.wavelength_nm, [486.1, 656.3, 486.1, 656.3, 500.0, 500.0]);
    assert_eq!(rays.origins[2], [0.0, 0.0, 7.0, 7.0, 0.0, 0.0]);
    assert_eq!(rays.directions[2], [1.0, 0.0, 1.0, 0.0, 1.0, 1.0]);
    assert_eq!(rays.origins[1][5], 5.0);
}

#[test]
fn problems_of_files_of_rays() {
    let problems = |source: &str, csv: &[u8]| {
        let text = format!(
            "[solid.a]\nsphere = {{ radius = 1 }}\n[optics.medium]\na = 'N-BK7'\n[[optics.source]]\n{source}"
        );
        read_in_folder("problems", &text, &[("rays.csv", csv)]).map(|_| ()).unwrap_err().to_string()
    };
    let rays = "rays = { file = 'rays.csv' }";
    let missing = problems("rays = { file = 'none.csv' }", b"");
    assert!(missing.contains("none.csv") && missing.contains("7 |"), "{missing}");
    assert!(problems(rays, b"").contains("the file is empty"));
    assert!(
        problems(rays, b"ox,oy,oz,dx,dy,dz\n").contains("the file has no rays: a source needs at least one.")
    );
    let bad = problems(
        rays,
        b"ox,oy,oz,dx,dy,dz,power\n0,0,0,0,0,1,nan\n0,0,nan,0,0,1,1\n0,0,0,0,0,1,-2\n0,0,0,0,0,1\n",
    );
    for problem in [
        "power is NaN",
        "oz is NaN",
        "power is -2: it must be finite and nonnegative",
        "6 fields: a ray has seven",
    ] {
        assert!(bad.contains(problem), "{bad}");
    }
    let own = problems(
        &format!("{rays}\nwavelength_nm = 500"),
        b"ox,oy,oz,dx,dy,dz,wavelength_nm\n0,0,0,0,0,1,500\n",
    );
    assert!(own.contains("the rays have their own wavelengths"), "{own}");
    let beyond = problems(rays, b"ox,oy,oz,dx,dy,dz,wavelength_nm\n0,0,0,0,0,1,500\n0,0,0,0,0,1,5000\n");
    assert!(beyond.contains("the source emits at 500 nm to 5000 nm"), "{beyond}");
    let slip = problems(rays, b"ox,oy,oz,dx,dy,dz,powr\n0,0,0,0,0,1,500\n");
    assert!(slip.contains("Did you mean power?"), "{slip}");
}

/// A file elsewhere is rejected, even behind a symbolic link, until it is allowed.
#[test]
#[cfg(unix)]
fn files_of_rays_outside_the_folder() {
    use std::fs;
    let root = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("optics-file-outside");
    let _ = fs::remove_dir_all(&root);
    fs::create_dir_all(root.join("model")).unwrap();
    let other = root.join("rays.csv");
    fs::write(&other, "ox,oy,oz,dx,dy,dz\n0,0,0,0,0,1\n0,5,0,0,0,1\n").unwrap();
    std::os::unix::fs::symlink(&other, root.join("model/link.csv")).unwrap();
    let model = root.join("model/model.toml");
    let read = |file: &str, allowed: &[&std::path::Path]| {
        let text = format!("rayweave = 1\n[optics]\n[[optics.source]]\nrays = {{ file = '{file}' }}\n");
        fs::write(&model, text).unwrap();
        let allowed: Vec<_> = allowed.iter().map(|path| path.to_path_buf()).collect();
        let (document, scene) = rayweave_scene::load_allowing(&model, &[], &allowed).unwrap();
        let optics = rayweave_optics::file::optics_of(&document, &scene);
        optics.map(|optics| optics.sources.count()).map_err(|problems| problems.to_string())
    };
    for file in ["../rays.csv", "link.csv", other.to_str().unwrap(), "../missing.csv"] {
        let refused = read(file, &[]).unwrap_err();
        assert!(refused.contains("outside the folder of the model"), "{file}: {refused}");
        assert!(refused.contains("--allow-path") && refused.contains("`allow`"), "{file}: {refused}");
        // the position of the name
        assert!(refused.contains("model.toml:4:17"), "{file}: {refused}");
    }
    for file in ["../rays.csv", "link.csv", other.to_str().unwrap()] {
        assert_eq!(read(file, &[&other]), Ok(2), "{file}");
        assert_eq!(read(file, &[&root]), Ok(2), "{file}");
    }
}
