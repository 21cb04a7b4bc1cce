use hwasp_fabrication::{SeatedSpring, Workshop, coupon, parts};
use hwasp_tasks::hand::{HandDescription, SEARCHED};
#[test]
fn dump() {
    let springs = [
        SeatedSpring { wire: 0.38e-3, outer: 5.26e-3, length: 2.60e-3 },
        SeatedSpring { wire: 0.36e-3, outer: 6.72e-3, length: 2.45e-3 },
        SeatedSpring { wire: 0.45e-3, outer: 6.90e-3, length: 3.17e-3 },
        SeatedSpring { wire: 0.38e-3, outer: 6.76e-3, length: 3.07e-3 },
    ];
    let t = std::time::Instant::now();
    let mut all = parts(&HandDescription::default(), &SEARCHED, &springs, &Workshop::default()).unwrap();
    println!("{:?}", t.elapsed());
    all.push(coupon(&springs, &Workshop::default()).unwrap());
    std::fs::create_dir_all("/tmp/h/stl").unwrap();
    for p in &all {
        println!(
            "{:25} {:.2} cm3 {:.1?} {}",
            p.name,
            p.mesh.volume() * 1e6,
            p.mesh.bounds().map(|b| b.map(|v| (v * 1e4).round() / 10.0)),
            p.mesh.triangles().len()
        );
        std::fs::write(format!("/tmp/h/stl/{}.stl", p.name), p.mesh.stl(p.name)).unwrap();
    }
}
