//! Contents of drawings of sections.

use rayweave_analysis::section::{CrossSection, SectionPlane, SectionSettings, cross_sections};
use rayweave_draw::section::{section_dxf, section_svg};
use rayweave_trace::AnyEvaluator;

fn cut(text: &str, planes: &[SectionPlane]) -> Vec<CrossSection> {
    let (_, scene) = rayweave_scene::parse(&format!("rayweave = 1\n{text}")).unwrap();
    let settings = SectionSettings::default();
    cross_sections(&scene, None, AnyEvaluator::maker(None), planes, &settings, &mut |_| ()).unwrap()
}

#[test]
fn a_stack_of_a_cone() {
    let plane: SectionPlane = "xy".parse().unwrap();
    let planes = plane.stack(-0.75, 0.75, 0.5).unwrap();
    let found = cut("[solid.cone]\ncone = { radius1 = 2, radius2 = 0, height = 2 }", &planes);
    let svg = section_svg(&found, "a cone", "mm");
    assert_eq!(svg.matches("class=\"cut\"").count(), 4);
    assert!(svg.contains("z = -0.75") && svg.contains("4 planes"), "{svg}");
    let text = section_dxf(&found, "mm");
    assert_eq!(text.matches("CIRCLE").count(), 4);
}

/// Transparent parts are drawn only where there is nothing else.
#[test]
fn transparent_parts_are_drawn_alone() {
    let text = "[solid.air]\nbox = { size = [9, 9, 9] }\n[solid.ball]\nsphere = { radius = 2 }\n\
                [[region]]\nsolid = \"air\"\ncolour = \"#ffffff00\"\n[[region]]\nsolid = \"ball\"";
    let svg = |plane: &str| section_svg(&cut(text, &[plane.parse().unwrap()]), "a ball in air", "mm");
    let (both, air) = (svg("z=0"), svg("z=3"));
    assert!(both.contains(">ball<") && !both.contains(">air<"), "{both}");
    assert!(air.matches("class=\"cut\"").count() == 1 && air.contains(">air<"), "{air}");
}
