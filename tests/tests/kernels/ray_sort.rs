use bytemuck::Zeroable;
use gridwalk::Ray;
use gridwalk::kernels::{RAY_KEYS, RAY_SORT_ARGS};
use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::intersect::move_ray;
use gridwalk_core::layout::{BuildState, DispatchArguments};
use gridwalk_core::twin::ray_keys::{RAY_KEY_BITS, RAY_KEY_WITHOUT_WALK, ray_key, ray_keys};
use gridwalk_core::twin::ray_sort_args::ray_sort_args;
use gridwalk_tests::gpu::CANARY;

use super::{assert_same, devices, header};
use crate::traverse::{meshes, rays};

#[test]
fn ray_sort_args_of_every_size() {
    for gpu in devices() {
        let shape = gpu.tracer.shape();
        // Shapes this small run out of numbers of workgroups; nobody sorts so many rays with them.
        let most = if shape.sort_tile() < 64 { 1 << 24 } else { 1 << 28 };
        let edges = [1, shape.map_size, shape.sort_tile(), 65_535 * shape.map_size, most - 1];
        let maxima = edges.iter().flat_map(|edge| [edge - 1, *edge, edge + 1]);
        for (max, count) in maxima.flat_map(|max| [(max, None), (max, Some(7)), (max, Some(u32::MAX))]) {
            let what = format!("{count:?} rays of {max}, {shape:?}");
            let (mut state, mut arguments) = (BuildState::default(), DispatchArguments::zeroed());
            let (device_state, device_arguments) = (gpu.upload("state", &[state]), gpu.upload("arguments", &[arguments]));
            let device_count = gpu.upload("count", &[count.unwrap_or(CANARY)]);
            let memory = [&device_state, &device_arguments, &device_count];
            gpu.launch(&RAY_SORT_ARGS, 0, &memory, &[max, u32::from(count.is_some())], [1, 1, 1]);
            ray_sort_args(&shape, &mut state, &mut arguments, count, max);
            assert_same(&format!("{what}: state"), &device_state.read::<BuildState>(0, 1), &[state]);
            assert_same(&format!("{what}: arguments"), &device_arguments.read::<DispatchArguments>(0, 1), &[arguments]);
            assert_eq!(state.pair_count, max.min(count.unwrap_or(max)), "{what}");
            assert!(state.pass_count * state.digit_bits >= RAY_KEY_BITS && state.digit_bits <= shape.sort_bits, "{what}");
        }
    }
}

#[test]
fn ray_keys_of_all_kinds_of_rays() {
    let mesh = meshes::soup(500, 0.2, 31);
    let header = header(&mesh, 8.0, [0; 3]);
    let mut rays = rays::random_rays(&mesh, 5_000, 32);
    rays.extend(rays::diffuse_rays(&mesh, 5_000, 33));
    rays.extend(rays::hard_rays(&mesh, &header, 34).into_iter().step_by(5));
    let valid = rays.len();
    rays.extend(rays::invalid_rays());
    for gpu in devices() {
        let shape = gpu.tracer.shape();
        for count in [0, 1, valid, rays.len()] {
            let what = format!("{count} rays, {shape:?}");
            let state = gpu.upload("state", &[BuildState { pair_count: count as u32, ..BuildState::default() }]);
            let (grid, device_rays) = (gpu.upload("grid", &[header]), gpu.upload("rays", &rays));
            let [keys, values] = ["keys", "values"].map(|name| gpu.guarded(name, 4 * rays.len() as u64));
            let groups = split_workgroups(rays.len() as u32, shape.map_size);
            gpu.launch(&RAY_KEYS, 0, &[&grid, &device_rays, &state, &keys, &values], &[], groups);
            let (mut expected, mut places) = (vec![CANARY; rays.len()], vec![CANARY; rays.len()]);
            ray_keys(&header, &rays[..count], &mut expected, &mut places);
            assert_same(&format!("{what}: values"), &values.read::<u32>(0, rays.len()), &places);
            let found = keys.read::<u32>(0, rays.len());
            // A GPU's divisions may be off by 2.5 ulp: then a ray on the border of two cells has either's key.
            let different = found.iter().zip(&expected).filter(|(found, expected)| found != expected).count();
            assert!(different <= if gpu.context.is_cpu() { 0 } else { count / 100 }, "{what}: {different} keys differ");
        }
    }
    let key = |ray: &Ray| ray_key(move_ray(ray, &header).as_ref(), &header);
    assert!(rays[valid..].iter().all(|ray| key(ray) == RAY_KEY_WITHOUT_WALK), "no invalid ray is walked");
    assert!(rays[..valid].iter().filter(|ray| key(ray) != RAY_KEY_WITHOUT_WALK).count() > 5_000, "most of the others are");
    // Near rays have near keys: what the order is for.
    let origin = [header.box_min, header.box_max].map(|corner| corner.map(|along| along * header.inverse_scale));
    let at = |part: f32, direction| Ray {
        origin: std::array::from_fn(|axis| origin[0][axis] + part * (origin[1][axis] - origin[0][axis]) + header.middle[axis]),
        t_min: 0.0,
        direction,
        t_max: 10.0,
    };
    let (low, high) = (key(&at(0.01, [1.0, 0.5, 0.2])), key(&at(0.99, [1.0, 0.5, 0.2])));
    assert_eq!(low >> 6, 0, "the first cell of the box");
    assert!(high > low, "{high:#x} lies at the other end");
    assert_eq!(low, key(&at(0.011, [1.0, 0.4, 0.3])));
    assert_eq!(low ^ key(&at(0.01, [1.0, 0.5, -0.2])), 32, "one sign is one bit");
}
