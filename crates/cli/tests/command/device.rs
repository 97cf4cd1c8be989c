//! `--device`: graphics cards beside the CPU. With the feature `gpu` the tests need an adapter, such as lavapipe, and are skipped
//! with a message where there is none.

use crate::bench::Bench;

const RENDER: [&str; 6] = ["render", "ball.toml", "-o", "out.png", "--size", "60x40"];

#[test]
fn wrong_arguments_of_devices() {
    let bench = Bench::new();
    let fails = |options: &[&str]| bench.fails(2, &[&RENDER, options].concat());
    let said = fails(&["--device", "gpu", "--evaluator", "weave"]);
    assert!(said.contains("evaluators are algorithms of the CPU"), "{said}");
    let said = fails(&["--adapter", "0"]);
    assert!(said.contains("add --device gpu"), "{said}");
    let said = fails(&["--device", "gpus"]);
    assert!(said.contains("[possible values: cpu, gpu, auto]"), "{said}");
    assert_eq!(bench.files(), ["ball.toml", "cemented.toml"]);
}

#[cfg(not(feature = "gpu"))]
mod without_the_feature {
    use super::*;

    #[test]
    fn the_message_tells_how_to_build_with_it_and_auto_uses_the_cpu() {
        let bench = Bench::new();
        bench.write("rays.csv", "ox,oy,oz,dx,dy,dz\n-5,0,0,1,0,0\n");
        let trace = ["trace", "ball.toml", "--rays", "rays.csv", "-o", "hits.csv"];
        for command in [&RENDER[..], &trace] {
            let said = bench.fails(2, &[command, &["--device", "gpu"]].concat());
            assert!(said.contains("built without the Cargo feature `gpu`"), "{said}");
            assert!(said.contains("Build it with `--features gpu`"), "{said}");
            let done = bench.run(&[command, &["--device", "auto"]].concat());
            assert_eq!(done.code, 0, "{}", done.err);
            assert!(
                done.err.starts_with("the CPU is used: ") && done.err.lines().count() == 1,
                "{}",
                done.err
            );
            bench.says(&[command, &["--device", "auto", "-q"]].concat());
        }
        assert_eq!(bench.read("hits.csv").lines().count(), 3);
    }
}

#[cfg(feature = "gpu")]
mod with_the_feature {
    use super::*;

    /// False, with a message, if there is no adapter.
    fn has_adapter(bench: &Bench) -> bool {
        let done = bench.run(&["devices"]);
        if done.code != 0 {
            rayweave_conformance::skipped(&done.err);
        }
        done.code == 0
    }

    fn model(name: &str) -> String {
        format!("{}/../../models/{name}.toml", env!("CARGO_MANIFEST_DIR"))
    }

    #[test]
    fn pictures_have_the_bytes_of_the_cpu() {
        let bench = Bench::new();
        if !has_adapter(&bench) {
            return;
        }
        for name in ["die", "lens", "bracket"] {
            let model = model(name);
            for view in [&["--view", "front"][..], &["--view", "iso", "--shadows"]] {
                let picture = |out: &str, options: &[&str]| {
                    let files = ["render", &model, "-o", out, "--size", "120x90"];
                    let said = bench.says(&[&files, view, options].concat());
                    (bench.bytes(out), said)
                };
                let (cpu, _) = picture("cpu.png", &[]);
                let (gpu, said) = picture("gpu.png", &["--device", "gpu", "--adapter", "0"]);
                assert!(cpu == gpu, "{name}, {view:?}");
                println!("{name}, {view:?}: {said}");
                assert!(said.contains("rays uncertain") && !said.contains(" of 0 rays"), "{said}");
                assert!(!said.contains("contradicted"), "{said}");
            }
        }
    }

    #[test]
    fn tables_have_the_bytes_of_the_cpu() {
        let bench = Bench::new();
        if !has_adapter(&bench) {
            return;
        }
        // from outside and inside, beside the ball, along an edge of the boxes, and from afar
        let ray = |k: usize| {
            let (y, z) = ((k % 41) as f64 / 20.0 - 1.0, (k / 41) as f64 / 20.0 - 1.0);
            let x = [-5.0, 0.5, -1e6][k % 3];
            format!("{x},{y},{z},{},{},0.1\n", if k.is_multiple_of(7) { 0.0 } else { 1.0 }, z / 3.0)
        };
        let rays = (0..1681).map(ray).collect::<String>();
        bench.write("rays.csv", format!("ox,oy,oz,dx,dy,dz\n{rays}"));
        for options in [&["--nearest"][..], &["--t-min", "-3", "--t-max", "6"], &["--occurrence"]] {
            let table = |out: &str, device: &[&str]| {
                let files = ["trace", "cemented.toml", "--rays", "rays.csv", "-o", out];
                let said = bench.says(&[&files, options, device].concat());
                (bench.bytes(out), said)
            };
            let (cpu, first) = table("cpu.csv", &[]);
            let (gpu, said) = table("gpu.csv", &["--device", "gpu"]);
            assert!(cpu == gpu, "{options:?}");
            let share = said.lines().nth(1).unwrap();
            assert!(share.starts_with("GPU: ") && share.contains(" of 1681 rays uncertain"), "{said}");
            assert_eq!(
                first.lines().next().map(|line| line.replace("cpu", "gpu")).as_deref(),
                said.lines().next()
            );
            println!("{options:?}: {said}");
        }
    }

    #[test]
    fn adapters_that_do_not_exist() {
        let bench = Bench::new();
        if !has_adapter(&bench) {
            return;
        }
        let said = bench.fails(2, &[&RENDER[..], &["--device", "gpu", "--adapter", "99"]].concat());
        assert!(said.contains("GPU 99 does not exist"), "{said}");
        let done = bench.run(&[&RENDER[..], &["--device", "auto", "--adapter", "99"]].concat());
        assert_eq!(done.code, 0, "{}", done.err);
        assert!(done.err.starts_with("the CPU is used: GPU 99 does not exist"), "{}", done.err);
    }

    #[test]
    fn without_a_driver_the_message_names_the_packages() {
        let bench = Bench::new();
        let run = |device: &str, quiet: &[&str]| {
            let mut command = bench.command(&[&RENDER[..], &["--device", device], quiet].concat());
            let none = bench.path("none.json");
            command.env("VK_DRIVER_FILES", &none).env("VK_ICD_FILENAMES", &none).output().unwrap()
        };
        let gpu = run("gpu", &[]);
        let said = String::from_utf8(gpu.stderr).unwrap();
        assert!(gpu.status.code() == Some(2) && said.contains("mesa-vulkan-drivers"), "{said}");
        assert!(!bench.path("out.png").exists());
        let auto = run("auto", &[]);
        let said = String::from_utf8(auto.stderr).unwrap();
        assert!(auto.status.success() && said.starts_with("the CPU is used: no GPU was found"), "{said}");
        assert!(run("auto", &["-q"]).stderr.is_empty());
    }

    #[test]
    fn photons_have_the_bytes_of_the_cpu() {
        let bench = crate::photons::bench();
        if !has_adapter(&bench) {
            return;
        }
        let hits = |device: &[&str], out: &str| {
            let said = bench.says(&crate::photons::run(&[device, &["-o", out]].concat()));
            (bench.read(out), said)
        };
        let (cpu, _) = hits(&[], "cpu.csv");
        let (gpu, said) = hits(&["--device", "gpu"], "gpu.csv");
        assert!(cpu == gpu);
        assert!(said.contains(" of 2000 photons finished by the CPU"), "{said}");
        let found = bench.json(&crate::photons::run(&["--device", "gpu", "--json"]));
        assert_eq!(found["gpu"]["photons"], 2000);
        let said = bench.fails(2, &crate::photons::run(&["--device", "gpu", "--counts"]));
        assert!(said.contains("cannot be recorded on the device `gpu`"), "{said}");
        let done = bench.run(&crate::photons::run(&["--device", "auto", "--adapter", "0", "--counts"]));
        assert!(done.code == 0 && done.err.contains("the CPU is used: steps and histories"), "{}", done.err);
    }
}
