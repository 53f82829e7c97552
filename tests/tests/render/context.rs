//! The device: choosing it, its memory, what it says when something is not there.

use gridwalk_render::{
    BufferDesc, BufferKind, BuildSettings, Context, ContextDesc, DeviceSelector, Error, GpuScene, GridBuilder, RayBatch, list_devices,
};
use gridwalk_scene::generate;

use super::{context, matt, scene};

fn buffer(name: &str, size: u64) -> BufferDesc<'_> {
    BufferDesc { name, size, kind: BufferKind::Device, dedicated: false }
}

fn limited(bytes: u64) -> Context {
    Context::new(&ContextDesc { memory_limit: Some(bytes), validation: true, name: "limited", ..ContextDesc::default() }).unwrap()
}

#[test]
fn devices_are_listed_and_found() {
    let devices = list_devices().unwrap();
    let device = devices.iter().find(|device| device.is_suitable()).expect("a device that can serve");
    assert!(!device.name.is_empty() && device.limits.max_buffer_bytes > 0 && device.limits.heap_bytes > 0, "{device:?}");
    let part: String = device.name.to_uppercase().chars().take(5).collect();
    for selector in
        [DeviceSelector::Index(device.index), DeviceSelector::Uuid(device.uuid), DeviceSelector::Name(part), DeviceSelector::Best]
    {
        let context = Context::new(&ContextDesc { device: selector.clone(), ..ContextDesc::default() }).unwrap();
        assert!(context.device_info().is_suitable(), "{selector}");
    }
}

#[test]
fn a_device_that_is_not_there_is_named_with_those_that_are() {
    for selector in [DeviceSelector::Index(1000), DeviceSelector::Name("abacus".into()), DeviceSelector::Uuid([7; 16])] {
        let error = Context::new(&ContextDesc { device: selector.clone(), ..ContextDesc::default() }).unwrap_err();
        let text = error.to_string();
        assert!(matches!(error, Error::NoSuchDevice { .. }), "{text}");
        assert!(text.contains(&selector.to_string()) && text.contains(&list_devices().unwrap()[0].name), "{text}");
    }
}

#[test]
fn selectors_are_read() {
    let read = |text: &str| text.parse::<DeviceSelector>().unwrap();
    assert_eq!(read("cpu"), DeviceSelector::Cpu);
    assert_eq!(read(""), DeviceSelector::Best);
    assert_eq!(read("2"), DeviceSelector::Index(2));
    assert_eq!(read("llvmpipe"), DeviceSelector::Name("llvmpipe".into()));
    let uuid = read("6d657361-3232-2e33-2e36-000000000000");
    assert!(matches!(uuid, DeviceSelector::Uuid(_)));
    assert_eq!(uuid.to_string(), "6d657361-3232-2e33-2e36-000000000000");
    assert!(matches!(read("6d657361-3232-2e33-2e36-00000000000g"), DeviceSelector::Name(_)));
}

#[test]
fn what_is_written_is_read_back() {
    let data: Vec<u32> = (0..100_000).map(|i: u32| i.wrapping_mul(2_654_435_761)).collect();
    for kind in [BufferKind::Device, BufferKind::Upload, BufferKind::Readback] {
        let buffer = context().buffer(&BufferDesc { name: "data", size: 400_000, kind, dedicated: kind == BufferKind::Device }).unwrap();
        assert!(buffer.address().is_multiple_of(64) && buffer.address() != 0);
        buffer.write(0, &data).unwrap();
        assert_eq!(buffer.read::<u32>(0, data.len()).unwrap(), data, "{kind:?}");
        assert_eq!(buffer.read::<u32>(40, 5).unwrap(), data[10..15]);
        buffer.write(400_000 - 4, &[7_u32]).unwrap();
        assert_eq!(buffer.read::<u32>(400_000 - 8, 2).unwrap(), [data[99_998], 7]);
        let beyond = buffer.write(400_000, &[7_u32]).unwrap_err();
        assert!(matches!(beyond, Error::OutOfRange { size: 400_000, begin: 400_000, end: 400_004, .. }), "{beyond}");
        assert!(matches!(buffer.read::<u32>(u64::MAX, usize::MAX), Err(Error::OutOfRange { .. })));
    }
}

#[test]
fn too_large_a_buffer_is_refused_and_the_context_goes_on() {
    const MIB: u64 = 1 << 20;
    let context = limited(16 * MIB);
    for size in [17 * MIB, 1 << 50, u64::MAX - 1000] {
        match context.buffer(&buffer("the whale", size)) {
            Err(Error::OutOfDeviceMemory { name, needed, available }) => {
                assert_eq!(name, "the whale");
                assert!(needed >= size && available <= 16 * MIB, "{needed} {available}");
            }
            other => panic!("{other:?}"),
        }
    }
    let first = context.buffer(&buffer("first", 10 * MIB)).unwrap();
    assert!(matches!(context.buffer(&buffer("second", 10 * MIB)), Err(Error::OutOfDeviceMemory { .. })));
    assert_eq!(context.allocated_bytes(), 10 * MIB);
    drop(first);
    let second = context.buffer(&buffer("second", 10 * MIB)).unwrap();
    second.write(0, &[1_u32, 2, 3]).unwrap();
    assert_eq!(second.read::<u32>(0, 3).unwrap(), [1, 2, 3]);
    drop(second);
    assert_eq!((context.allocated_bytes(), context.peak_bytes()), (0, 10 * MIB));
    assert_eq!(context.take_validation_messages(), Vec::<String>::new());
}

#[test]
fn what_exceeds_the_device_is_refused_without_a_limit_of_ours() {
    let bytes = context().device_info().limits.heap_bytes;
    let error = context().buffer(&buffer("the heap", bytes + 16)).unwrap_err();
    assert!(matches!(error, Error::OutOfDeviceMemory { .. }), "{error}");
}

/// Every allocation of an upload, a build and a trace fails once; none of them leaves anything behind.
#[test]
fn memory_may_run_out_anywhere() {
    let scene = scene(vec![(generate::sphere([0.0; 3], 1.0, 48), matt(0.5))]);
    let rays = vec![gridwalk::Ray { origin: [0.0, 0.0, 5.0], t_min: 0.0, direction: [0.0, 0.0, -1.0], t_max: 100.0 }; 1000];
    let mut failures = 0;
    let mut limit = 1_u64 << 14;
    loop {
        let context = limited(limit);
        let made = (|| {
            let gpu = GpuScene::upload(&context, &scene)?;
            let mut grid = GridBuilder::new(&context)?.build(&gpu, &BuildSettings::default())?;
            let mut batch = RayBatch::new(&context, &rays)?;
            batch.closest_hit(&grid)?;
            grid.free_scratch();
            grid.rebuild(&gpu)?;
            Ok::<_, Error>(batch.read_hits()?.iter().all(gridwalk::Hit::is_hit))
        })();
        match made {
            Ok(hit) => {
                assert!(hit);
                break;
            }
            Err(Error::OutOfDeviceMemory { .. }) => failures += 1,
            Err(error) => panic!("{error}"),
        }
        assert_eq!(context.allocated_bytes(), 0);
        assert_eq!(context.take_validation_messages(), Vec::<String>::new());
        limit *= 2;
        assert!(limit < 1 << 28, "never enough");
    }
    assert!(failures > 3, "{failures} failures: the limit has no effect");
}
