//! glTF files made here, feature by feature.

use std::path::Path;

use gridwalk_scene::{Animation, AnimationOptions, Error, Light, LoadOptions, Mesh, Motion, Scene, Texture, load, open};
use serde_json::{Value, json};
use tempfile::TempDir;

use super::{folder, png};

/// A glTF file in the making: JSON, and one buffer that grows.
#[derive(Clone)]
pub(super) struct Maker {
    pub(super) json: Value,
    pub(super) data: Vec<u8>,
}

pub(super) const U8: u32 = 5121;
pub(super) const I8: u32 = 5120;
pub(super) const I16: u32 = 5122;
pub(super) const U16: u32 = 5123;
pub(super) const F32: u32 = 5126;

impl Maker {
    pub(super) fn new() -> Maker {
        Maker { json: json!({ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }] }), data: Vec::new() }
    }

    /// Adds to one of the lists and returns the number.
    pub(super) fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.json.as_object_mut().unwrap().entry(list).or_insert_with(|| json!([])).as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    pub(super) fn view(&mut self, bytes: &[u8]) -> usize {
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        let offset = self.data.len();
        self.data.extend(bytes);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    pub(super) fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.push("accessors", json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }))
    }

    pub(super) fn floats(&mut self, values: &[f32], kind: &str) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(&bytes, F32, kind, values.len() / width)
    }

    pub(super) fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(&bytes, U16, "SCALAR", values.len())
    }

    /// A mesh of one primitive on a node of its own.
    pub(super) fn mesh(&mut self, primitive: Value) -> usize {
        let mesh = self.push("meshes", json!({ "primitives": [primitive] }));
        self.push("nodes", json!({ "mesh": mesh }))
    }

    /// The corner triangle of the first three axes' ends, with normals along +z, on node 0.
    pub(super) fn triangle() -> Maker {
        let mut maker = Maker::new();
        let positions = maker.floats(TRIANGLE.as_flattened(), "VEC3");
        let normals = maker.floats([[0.0, 0.0, 1.0]; 3].as_flattened(), "VEC3");
        let uvs = maker.floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 0.25], "VEC2");
        maker.mesh(json!({ "attributes": { "POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs } }));
        maker
    }

    /// The same with material 0.
    pub(super) fn with_material(material: Value) -> Maker {
        let mut maker = Maker::triangle();
        maker.json["materials"] = json!([material]);
        maker.json["meshes"][0]["primitives"][0]["material"] = json!(0);
        maker
    }

    /// Adds a picture of one row as texture.
    pub(super) fn texture(&mut self, colour: png::ColorType, row: &[u8]) -> usize {
        let view = self.view(&png(colour, row));
        let image = self.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
        self.push("textures", json!({ "source": image }))
    }

    /// A clip of one channel.
    pub(super) fn animate(&mut self, node: usize, path: &str, interpolation: &str, times: &[f32], values: &[f32]) {
        let kind = match path {
            "rotation" => "VEC4",
            "weights" => "SCALAR",
            _ => "VEC3",
        };
        let (input, output) = (self.floats(times, "SCALAR"), self.floats(values, kind));
        if self.json.get("animations").is_none() {
            self.push("animations", json!({ "channels": [], "samplers": [] }));
        }
        let animation = &mut self.json["animations"][0];
        let sampler = animation["samplers"].as_array().unwrap().len();
        let samplers = animation["samplers"].as_array_mut().unwrap();
        samplers.push(json!({ "input": input, "output": output, "interpolation": interpolation }));
        let channels = animation["channels"].as_array_mut().unwrap();
        channels.push(json!({ "sampler": sampler, "target": { "node": node, "path": path } }));
    }

    /// As text with a data uri.
    pub(super) fn text(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        let uri = format!("data:application/octet-stream;base64,{}", base64(&self.data));
        json["buffers"] = json!([{ "byteLength": self.data.len(), "uri": uri }]);
        serde_json::to_vec(&json).unwrap()
    }

    pub(super) fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.data.len() }]);
        glb(&serde_json::to_vec(&json).unwrap(), &self.data)
    }

    pub(super) fn write(&self) -> TempDir {
        folder(&[("a.glb", &self.glb())])
    }

    pub(super) fn open(&self, clip: Option<&str>) -> Result<Animation, Error> {
        open_in(&self.write(), clip)
    }

    pub(super) fn animation(&self) -> Animation {
        self.open(None).unwrap()
    }

    pub(super) fn scene(&self) -> Scene {
        let scene = self.animation().scene;
        assert_eq!(scene.warnings, [""; 0]);
        scene
    }

    /// The only mesh.
    pub(super) fn only_mesh(&self) -> Mesh {
        let mut meshes = self.scene().meshes;
        assert_eq!(meshes.len(), 1);
        meshes.remove(0)
    }

    /// What is said about the file, without its name.
    pub(super) fn message(&self) -> String {
        let folder = self.write();
        let message = open_in(&folder, None).unwrap_err().to_string();
        super::without_folder(&message, folder.path()).replace("DIR/a.glb: ", "")
    }

    fn warnings(&self) -> Vec<String> {
        let folder = self.write();
        let warnings = open_in(&folder, None).unwrap().scene.warnings;
        warnings.iter().map(|warning| super::without_folder(warning, folder.path()).replace("DIR/a.glb: ", "")).collect()
    }
}

pub(super) const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

fn open_in(folder: &TempDir, clip: Option<&str>) -> Result<Animation, Error> {
    let mut options = AnimationOptions::default();
    options.clip = clip.map(str::to_owned);
    open(&folder.path().join("a.glb"), &LoadOptions::default(), &options)
}

pub(super) fn glb(json: &[u8], data: &[u8]) -> Vec<u8> {
    let padded = |bytes: &[u8], fill: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), fill);
        bytes
    };
    let (json, data) = (padded(json, b' '), padded(data, 0));
    let mut bytes = b"glTF".to_vec();
    let length = 12 + 8 + json.len() + 8 + data.len();
    for word in [2, length as u32, json.len() as u32] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(data);
    bytes
}

pub(super) fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let coded = bytes.chunks(3).flat_map(|bytes| {
        let word = (0..3).fold(0_u32, |word, at| word << 8 | u32::from(bytes.get(at).copied().unwrap_or(0)));
        let digit = move |at: usize| if at <= bytes.len() { char::from(DIGITS[(word >> (18 - 6 * at) & 63) as usize]) } else { '=' };
        (0..4).map(digit).collect::<Vec<_>>()
    });
    coded.collect()
}

fn texture(scene: &Scene, number: Option<u32>) -> &Texture {
    &scene.textures[number.unwrap() as usize]
}

fn near(a: &[f32], b: &[f32], tolerance: f32) {
    assert_eq!(a.len(), b.len());
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance), "{a:?} is not {b:?}");
}

#[test]
fn text_and_binary_give_the_same_scene() {
    let maker = Maker::triangle();
    let folder = folder(&[("a.glb", &maker.glb()), ("a.gltf", &maker.text()), ("b.gltf", b"{}")]);
    let read = |name: &str| load(&folder.path().join(name), &LoadOptions::default());
    let (binary, text) = (read("a.glb").unwrap(), read("a.gltf").unwrap());
    assert_eq!(binary.meshes, text.meshes);
    assert_eq!(binary.meshes[0].positions, TRIANGLE);
    assert_eq!(binary.meshes[0].uvs, [[0.0, 1.0], [1.0, 1.0], [0.0, 0.75]], "v goes upwards here and downwards in glTF");
    assert_eq!(binary.lights.len(), 2, "the default lights");
    assert!(read("b.gltf").is_err());
}

#[test]
fn buffers_and_images_in_files_of_their_own() {
    let mut maker = Maker::with_material(json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0 } }));
    maker.json["textures"] = json!([{ "source": 0 }]);
    maker.json["images"] = json!([{ "uri": "pictures/a%20b.png" }]);
    maker.json["buffers"] = json!([{ "byteLength": maker.data.len(), "uri": "a.bin" }]);
    let text = serde_json::to_vec(&maker.json).unwrap();
    let picture = png(png::ColorType::Rgb, &[200, 100, 50]);
    let files: [(&str, &[u8]); 3] = [("s/a.gltf", &text), ("s/a.bin", &maker.data), ("s/pictures/a b.png", &picture)];
    let inside = folder(&files);
    let scene = load(&inside.path().join("s/a.gltf"), &LoadOptions::default()).unwrap();
    assert_eq!(scene.warnings, [""; 0]);
    assert_eq!(texture(&scene, scene.materials[1].diffuse_map).pixels, [200, 100, 50, 255]);

    // What lies outside stays closed, a buffer as an error and a picture as a warning.
    let closed = |image: &str, buffer: &str| {
        maker.json["images"] = json!([{ "uri": image }]);
        maker.json["buffers"][0]["uri"] = json!(buffer);
        let text = serde_json::to_vec(&maker.json).unwrap();
        let outside = folder(&[("s/a.gltf", &text), ("a.bin", &maker.data), ("s/a.bin", &maker.data), ("p.png", &picture)]);
        load(&outside.path().join("s/a.gltf"), &LoadOptions::default())
    };
    let mut closed = closed;
    let scene = closed("../p.png", "a.bin").unwrap();
    assert!(scene.warnings[0].contains("outside") && scene.textures.is_empty(), "{:?}", scene.warnings);
    assert!(closed("../p.png", "../a.bin").is_ok(), "by its last part the file inside is found, as for other formats");
    assert!(matches!(closed("../p.png", "../b.bin"), Err(Error::NotFound { .. })));
    assert!(closed("../p.png", "http://127.0.0.1/a.bin").unwrap_err().to_string().contains("is not a file"));
}

#[test]
fn strips_fans_and_triangles_without_indices() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 2.0, 0.0_f32]];
    let case = |mode: u32, indices: Option<&[u16]>| {
        let mut maker = Maker::new();
        let positions = maker.floats(points.as_flattened(), "VEC3");
        let normals = maker.floats([[0.0, 0.0, 2.0]; 5].as_flattened(), "VEC3");
        let mut primitive = json!({ "attributes": { "POSITION": positions, "NORMAL": normals }, "mode": mode });
        if let Some(indices) = indices {
            primitive["indices"] = json!(maker.indices(indices));
        }
        maker.mesh(primitive);
        maker
    };
    assert_eq!(case(4, Some(&[0, 1, 2, 2, 1, 3])).only_mesh().indices, [[0, 1, 2], [2, 1, 3]]);
    let strip = case(5, None).only_mesh();
    assert_eq!(strip.indices, [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
    assert_eq!(strip.normals, [[0.0, 0.0, 1.0]; 5]);
    assert_eq!(case(5, Some(&[0, 1, 2, 2, 3, 3, 1, 4])).only_mesh().indices, [[0, 1, 2], [1, 3, 4]], "a strip may begin anew");
    assert_eq!(case(6, None).only_mesh().indices, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    let used = case(4, Some(&[0, 3, 4])).only_mesh();
    assert_eq!((used.indices, used.positions.len()), (vec![[0, 1, 2]], 3), "vertices that nobody uses are left out");
    assert_eq!(case(0, None).warnings(), ["mesh 0, primitive 0: points are not shown", "holds no triangles"]);
    assert!(case(1, None).warnings()[0].contains("lines"));
    assert!(case(4, None).warnings()[0].contains("5 indices are no whole number of triangles"));
    assert_eq!(case(4, Some(&[0, 1, 5])).message(), "mesh 0, primitive 0: the index 5 is not below the 5 vertices");
    assert!(case(9, None).message().contains("mode"));
}

#[test]
fn flat_normals_where_there_are_none() {
    let mut maker = Maker::new();
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0_f32]];
    let positions = maker.floats(points.as_flattened(), "VEC3");
    let indices = maker.indices(&[0, 1, 2, 0, 3, 1]);
    maker.mesh(json!({ "attributes": { "POSITION": positions }, "indices": indices }));
    let mesh = maker.only_mesh();
    assert_eq!(mesh.indices, [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(mesh.positions[4], points[3]);
    assert_eq!(mesh.normals[..3], [[0.0, 0.0, 1.0]; 3]);
    assert_eq!(mesh.normals[3..], [[0.0, 1.0, 0.0]; 3]);
}

#[test]
fn integers_strides_and_sparse_numbers() {
    // Positions as normalised shorts, two triangles interleaved with other bytes.
    let mut maker = Maker::new();
    let mut bytes = Vec::new();
    for point in [[0, 0, 0], [32767, 0, 0], [0, -32768, 16384_i16]] {
        bytes.extend(point.iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend([99, 99]);
    }
    let view = maker.view(&bytes);
    maker.json["bufferViews"][view]["byteStride"] = json!(8);
    let positions =
        maker.push("accessors", json!({ "bufferView": view, "componentType": I16, "count": 3, "type": "VEC3", "normalized": true }));
    let normals = maker.accessor(&[0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0][..11], I8, "VEC3", 3);
    maker.json["accessors"][normals]["normalized"] = json!(true);
    maker.json["bufferViews"][1]["byteStride"] = json!(4);
    let uvs = maker.accessor(&[0, 255, 51, 0, 255, 255], U8, "VEC2", 3);
    maker.json["accessors"][uvs]["normalized"] = json!(true);
    maker.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    maker.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    maker.mesh(json!({ "attributes": { "POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs } }));
    let mesh = maker.only_mesh();
    assert_eq!(mesh.positions[..2], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    near(&mesh.positions[2], &[0.0, -1.0, 16384.0 / 32767.0], 1e-7);
    near(mesh.uvs.as_flattened(), &[0.0, 0.0, 0.2, 1.0, 1.0, 0.0], 1e-7);

    // Without a stride of 4 the normals end behind their view.
    maker.json["bufferViews"][1]["byteStride"] = json!(8);
    assert!(maker.message().contains("end 19 bytes behind the start of bufferView 1, which has 11"), "{}", maker.message());

    // Sparse over zeros, and over numbers.
    for base in [false, true] {
        let mut maker = Maker::triangle();
        let indices = maker.view(&[2, 0]);
        let values: Vec<u8> = [5.0, 6.0, 7.0_f32].iter().flat_map(|value| value.to_le_bytes()).collect();
        let values = maker.view(&values);
        let accessor = &mut maker.json["accessors"][0];
        accessor["sparse"] = json!({
            "count": 1, "indices": { "bufferView": indices, "componentType": U16 }, "values": { "bufferView": values }
        });
        if !base {
            accessor.as_object_mut().unwrap().remove("bufferView");
        }
        let expected = if base { [TRIANGLE[0], TRIANGLE[1], [5.0, 6.0, 7.0]] } else { [[0.0; 3], [0.0; 3], [5.0, 6.0, 7.0]] };
        assert_eq!(maker.only_mesh().positions, expected);
        maker.json["accessors"][0]["sparse"]["count"] = json!(2);
        assert!(maker.message().contains("the sparse indices end behind"), "{}", maker.message());
        maker.data[maker.json["bufferViews"][indices]["byteOffset"].as_u64().unwrap() as usize] = 3;
        maker.json["accessors"][0]["sparse"]["count"] = json!(1);
        assert!(maker.message().contains("the sparse index 3 is not below the count of 3"), "{}", maker.message());
    }
}

#[test]
fn numbers_beyond_the_file_are_named() {
    let case = |change: &dyn Fn(&mut Value)| {
        let mut maker = Maker::triangle();
        change(&mut maker.json);
        maker.message()
    };
    let say = [
        case(&|json| json["accessors"][0]["count"] = json!(4_000_000_000_000_000_000_u64)),
        case(&|json| json["accessors"][0]["byteOffset"] = json!(u64::MAX)),
        case(&|json| json["bufferViews"][0]["byteLength"] = json!(1_u64 << 40)),
        case(&|json| json["bufferViews"][0]["buffer"] = json!(7)),
        case(&|json| json["accessors"][0]["bufferView"] = json!(70)),
        case(&|json| json["accessors"][0]["type"] = json!("VEC2")),
        case(&|json| json["accessors"][0]["componentType"] = json!(1)),
        case(&|json| json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(99)),
        case(&|json| json["meshes"][0]["primitives"][0]["material"] = json!(3)),
        case(&|json| json["nodes"][0]["mesh"] = json!(3)),
        case(&|json| json["nodes"][0]["skin"] = json!(3)),
        case(&|json| json["nodes"][0]["camera"] = json!(3)),
        case(&|json| json["nodes"][0]["children"] = json!([3])),
        case(&|json| json["scenes"][0]["nodes"] = json!([3])),
        case(&|json| json["scene"] = json!(3)),
        case(&|json| json["accessors"][1]["count"] = json!(2)),
    ];
    let expected = [
        "accessor 0: 4000000000000000000 elements end 18446744073709551615 bytes behind the start of bufferView 0, which has 36",
        "accessor 0: 3 elements end 18446744073709551615 bytes behind the start of bufferView 0, which has 36",
        "accessor 0: bufferView 0 ends behind the 96 bytes of buffer 0",
        "accessor 0: bufferView 0: there is no buffer 7, only 1 of them",
        "accessor 0: there is no bufferView 70, only 3 of them",
        "accessor 0: has 2 numbers an element where 3 are needed",
        "accessor 0: the type is none of glTF",
        "there is no accessor 99, only 3 of them",
        "there is no material 3, only 0 of them",
        "node 0: there is no mesh 3, only 1 of them",
        "node 0: there is no skin 3, only 0 of them",
        "node 0: there is no camera 3, only 0 of them",
        "node 0 has a child that is not there: there is no node 3, only 1 of them",
        "there is no node 3, only 1 of them",
        "there is no scene 3, only 1 of them",
        "mesh 0, primitive 0: 2 normals for 3 positions",
    ];
    assert_eq!(say, expected);
}

#[test]
fn zeros_that_no_file_holds_are_bounded() {
    let mut maker = Maker::triangle();
    let accessor = maker.json["accessors"][0].as_object_mut().unwrap();
    accessor.remove("bufferView");
    accessor.insert("count".to_owned(), json!(1_u64 << 40));
    assert!(maker.message().contains("unfolds to more than 4294967296 bytes"), "{}", maker.message());

    // A hundred thousand nodes with one mesh each.
    let mut maker = Maker::triangle();
    let nodes: Vec<Value> = (0..100_000).map(|_| json!({ "mesh": 0 })).collect();
    maker.json["scenes"][0]["nodes"] = (0..nodes.len()).collect();
    maker.json["nodes"] = json!(nodes);
    let folder = maker.write();
    let small = LoadOptions { max_mesh_bytes: 16 << 20, ..LoadOptions::default() };
    assert!(load(&folder.path().join("a.glb"), &small).unwrap_err().to_string().contains("unfolds to more"));
    assert_eq!(load(&folder.path().join("a.glb"), &LoadOptions::default()).unwrap().meshes.len(), 100_000);
}

#[test]
fn nodes_that_are_no_tree_are_refused() {
    let case = |nodes: Value| {
        let mut maker = Maker::triangle();
        maker.json["nodes"] = nodes;
        maker.message()
    };
    assert_eq!(
        case(json!([{ "mesh": 0 }, { "children": [2], "name": "a" }, { "children": [1] }])),
        "node 1 (\"a\") is below itself, or below such a node; nodes must form a tree"
    );
    assert_eq!(case(json!([{ "children": [0] }])), "node 0 is below itself, or below such a node; nodes must form a tree");
    assert_eq!(
        case(json!([{ "children": [1, 2] }, { "children": [2] }, {}])),
        "node 2 is a child of node 0 and of node 1; nodes must form a tree"
    );
    let deep: Vec<Value> = (0..3000).map(|at| if at < 2999 { json!({ "children": [at + 1] }) } else { json!({}) }).collect();
    assert!(case(json!(deep)).contains("more than 1024 nodes deep"));
    assert!(case(json!([{ "mesh": 0, "translation": [0, 0, 1e39] }])).contains("node 0: the place is not made of finite numbers"));
}

#[test]
fn nodes_place_and_mirror() {
    let mut maker = Maker::triangle();
    maker.json["nodes"] = json!([
        { "children": [1], "translation": [10, 0, 0], "rotation": [0, 0, 0.5_f64.sqrt(), 0.5_f64.sqrt()] },
        { "mesh": 0, "matrix": [2, 0, 0, 0, 0, -3, 0, 0, 0, 0, 1, 0, 0, 0, 7, 1], "name": "there" },
    ]);
    let mesh = maker.only_mesh();
    assert_eq!(mesh.name, "there");
    near(mesh.positions.as_flattened(), &[10.0, 0.0, 7.0, 10.0, 2.0, 7.0, 13.0, 0.0, 7.0], 1e-6);
    assert_eq!(mesh.indices, [[0, 2, 1]], "a mirror turns the winding");
    near(&mesh.normals[0], &[0.0, 0.0, 1.0], 1e-7);
}

#[test]
fn base_colour_metallic_and_roughness() {
    let rough = Maker::with_material(json!({ "name": "m", "pbrMetallicRoughness": {
        "baseColorFactor": [0.5, 0.25, 1.0, 1.0], "metallicFactor": 0, "roughnessFactor": 0.5
    } }));
    let scene = rough.scene();
    let material = &scene.materials[scene.meshes[0].materials[0] as usize];
    assert_eq!((material.name.as_str(), material.diffuse, material.illumination), ("m", [0.5, 0.25, 1.0], 2));
    // α = 0.25, so n = 30 and the lobe of 0.04 is 0.04 * 38 / 8 high.
    near(&[material.shininess], &[30.0], 1e-4);
    near(&material.specular, &[0.19; 3], 1e-5);

    let metal =
        Maker::with_material(json!({ "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.25, 1.0, 1.0], "roughnessFactor": 0.5 } }));
    let material = &metal.scene().materials[1];
    assert_eq!((material.name.as_str(), material.illumination), ("material 0", 3));
    near(&material.specular, &[0.125, 0.0625, 0.25], 1e-6);
    near(&material.diffuse, &[0.375, 0.1875, 0.75], 1e-6);

    let mirror = Maker::with_material(json!({ "pbrMetallicRoughness": { "roughnessFactor": 0 } }));
    let material = &mirror.scene().materials[1];
    assert_eq!((material.diffuse, material.specular, material.illumination), ([0.0; 3], [1.0; 3], 3));

    let glass = Maker::with_material(json!({
        "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 1 },
        "extensions": { "KHR_materials_ior": { "ior": 2 }, "KHR_materials_specular": { "specularFactor": 0.5 } }
    }));
    let material = &glass.scene().materials[1];
    assert_eq!(material.index_of_refraction, 2.0);
    near(&material.specular, &[0.5 / 9.0; 3], 1e-6);
}

#[test]
fn a_texture_of_metallic_and_roughness_splits_the_base_colour() {
    let pbr = json!({ "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 } });
    let mut maker = Maker::with_material(json!({ "pbrMetallicRoughness": pbr }));
    maker.texture(png::ColorType::Rgb, &[255, 128, 0, 255, 128, 0]);
    // Left a smooth metal, right a rough dielectric.
    maker.texture(png::ColorType::Rgb, &[0, 0, 255, 0, 255, 0]);
    let scene = maker.scene();
    let material = &scene.materials[1];
    let (diffuse, specular) = (texture(&scene, material.diffuse_map), texture(&scene, material.specular_map));
    assert_eq!((diffuse.srgb, specular.srgb, material.illumination), (true, true, 3));
    assert_eq!(diffuse.pixels, [0, 0, 0, 255, 255, 128, 0, 255]);
    assert_eq!(specular.pixels, [255, 128, 0, 255, 0, 0, 0, 255]);
    // The mean roughness is one half.
    near(&[material.shininess], &[30.0], 1e-3);

    // Nothing to mirror anywhere: the base colour stays as it is.
    maker.json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = json!(0);
    let scene = maker.scene();
    assert_eq!((scene.textures.len(), scene.materials[1].illumination), (1, 2));
    assert_eq!(scene.textures[0].pixels, [255, 128, 0, 255, 255, 128, 0, 255]);
}

#[test]
fn emission_unlit_and_normal_maps() {
    let mut maker = Maker::with_material(json!({
        "emissiveFactor": [1, 0.5, 0], "emissiveTexture": { "index": 0 }, "normalTexture": { "index": 1, "scale": 2 },
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 4 } }
    }));
    maker.texture(png::ColorType::Rgb, &[10, 20, 30]);
    maker.texture(png::ColorType::Rgb, &[255, 128, 128]);
    let scene = maker.scene();
    let material = &scene.materials[1];
    assert_eq!(material.emission, [4.0, 2.0, 0.0]);
    let emission = texture(&scene, material.emission_map);
    assert_eq!((emission.srgb, emission.pixels.as_slice()), (true, &[10, 20, 30, 255][..]));
    let normals = texture(&scene, material.normal_map);
    assert!(!normals.srgb && !material.normal_map_is_height);
    assert_eq!(normals.pixels[0], 255, "the slope is steep already");

    let mut maker = Maker::with_material(json!({
        "pbrMetallicRoughness": { "baseColorFactor": [1, 0.5, 0, 1], "baseColorTexture": { "index": 0 } },
        "extensions": { "KHR_materials_unlit": {} }
    }));
    maker.texture(png::ColorType::Rgb, &[10, 20, 30]);
    let scene = maker.scene();
    let material = &scene.materials[1];
    assert_eq!((material.emission, material.diffuse, material.specular), ([1.0, 0.5, 0.0], [0.0; 3], [0.0; 3]));
    assert_eq!(texture(&scene, material.emission_map).pixels, [10, 20, 30, 255]);
    assert_eq!((material.diffuse_map, material.unlit), (None, true));
    assert!(!Maker::with_material(json!({ "emissiveFactor": [1, 1, 1] })).scene().materials[1].unlit);
}

#[test]
fn masks_are_cut_at_their_cutoff() {
    let case = |mode: &str, cutoff: f32, factor: f32, alpha: &[u8]| {
        let mut maker = Maker::with_material(json!({
            "alphaMode": mode, "alphaCutoff": cutoff,
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "baseColorFactor": [1, 1, 1, factor], "metallicFactor": 0 }
        }));
        let row: Vec<u8> = alpha.iter().flat_map(|&alpha| [9, 9, 9, alpha]).collect();
        maker.texture(png::ColorType::Rgba, &row);
        let scene = maker.animation().scene;
        let map = scene.materials[1].opacity_map;
        map.map(|map| scene.textures[map as usize].pixels.chunks(4).map(|texel| texel[3] >= 128).collect::<Vec<_>>())
    };
    let all: Vec<u8> = (0..=255).collect();
    for (cutoff, factor) in [(0.5, 1.0), (0.1, 1.0), (0.9, 1.0), (0.3, 0.5), (0.5, 0.5), (0.002, 1.0)] {
        let expected: Vec<bool> = all.iter().map(|&alpha| f32::from(alpha) / 255.0 >= cutoff / factor).collect();
        assert_eq!(case("MASK", cutoff, factor, &all), Some(expected), "{cutoff} {factor}");
    }
    assert_eq!(case("MASK", 0.0, 1.0, &all), None);
    assert_eq!(case("MASK", 0.5, 0.4, &[255, 0]), Some(vec![false, false]), "never reached");
    assert_eq!(case("OPAQUE", 0.5, 1.0, &all), None);
}

#[test]
fn blending_is_factor_times_texture_times_vertex() {
    let make = |mode: &str, alpha: &[u8]| {
        let mut maker = Maker::with_material(json!({
            "alphaMode": mode,
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "baseColorFactor": [1, 1, 1, 0.6] }
        }));
        let row: Vec<u8> = alpha.iter().flat_map(|&alpha| [9, 8, 7, alpha]).collect();
        maker.texture(png::ColorType::Rgba, &row);
        maker
    };
    let scene = make("BLEND", &[0, 127, 255]).scene();
    let material = &scene.materials[1];
    assert_eq!((material.blend, material.opacity), (true, 0.6));
    let map = texture(&scene, material.opacity_map);
    assert_eq!((map.pixels.as_slice(), map.srgb), (&[0, 0, 0, 0, 127, 127, 127, 127, 255, 255, 255, 255][..], false));
    assert_eq!(make("BLEND", &[255, 255]).scene().materials[1].opacity_map, None, "all solid");
    let scene = make("OPAQUE", &[0, 127]).scene();
    assert_eq!((scene.materials[1].blend, scene.materials[1].opacity, scene.materials[1].opacity_map), (false, 1.0, None));

    let coloured = |mode: &str| {
        let mut maker = make(mode, &[255]);
        let colours = maker.floats(&[1.0, 0.5, 0.0, 0.25, 1.0, 1.0, 1.0, 7.0, 1.0, 1.0, 1.0, 1.0], "VEC4");
        maker.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colours);
        maker
    };
    let mesh = coloured("BLEND").only_mesh();
    assert_eq!((mesh.opacities, mesh.colours[0]), (vec![0.25, 1.0, 1.0], [1.0, 0.5, 0.0]));
    assert_eq!(coloured("OPAQUE").only_mesh().opacities, [0.0; 0]);
    assert_eq!(coloured("MASK").warnings(), ["mesh 0, primitive 0: the alpha of its vertices' colours is not cut by alphaMode MASK"]);
}

#[test]
fn texture_coordinates_and_their_transform() {
    let quarter = std::f32::consts::FRAC_PI_2;
    let transform = json!({ "offset": [0.5, 0.25], "rotation": quarter, "scale": [2, 3], "texCoord": 1 });
    let slot = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
    let mut maker = Maker::with_material(json!({ "pbrMetallicRoughness": { "baseColorTexture": slot }, "normalTexture": slot }));
    maker.texture(png::ColorType::Rgb, &[1, 2, 3]);
    let second = maker.floats(&[0.0, 0.0, 0.5, 0.0, 0.0, 0.5], "VEC2");
    maker.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(second);
    // Scaled, turned so that a picture's right becomes its up (v is less), moved; then v turned around.
    let expected = [[0.5, 0.75], [0.5, 1.75], [2.0, 0.75]];
    near(maker.only_mesh().uvs.as_flattened(), expected.as_flattened(), 1e-6);
    assert!(maker.scene().materials[1].normal_map.is_some());

    maker.json["materials"][0]["normalTexture"] = json!({ "index": 0 });
    assert_eq!(maker.warnings(), ["material 0: the normalTexture is looked up otherwise than the texture before it, and is not used"]);
    maker.json["materials"][0].as_object_mut().unwrap().remove("normalTexture");
    maker.json["samplers"] = json!([{ "wrapS": 33071 }]);
    maker.json["textures"][0]["sampler"] = json!(0);
    assert_eq!(maker.warnings(), ["mesh 0, primitive 0: the textures of material 0 are repeated; other wrapping is not supported"]);
    maker.json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("TEXCOORD_1");
    assert_eq!(maker.warnings(), ["mesh 0, primitive 0: there is no TEXCOORD_1 for the textures of material 0"]);
}

#[test]
fn colours_of_vertices() {
    let mut maker = Maker::triangle();
    let colours = maker.accessor(&[255, 0, 0, 9, 0, 255, 0, 9, 0, 0, 51, 9], U8, "VEC4", 3);
    maker.json["accessors"][colours]["normalized"] = json!(true);
    maker.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colours);
    near(maker.only_mesh().colours.as_flattened(), &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.2], 1e-7);
}

#[test]
fn pictures_that_cannot_be_read_cost_only_themselves() {
    let mut maker = Maker::with_material(json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
    let view = maker.view(b"RIFF....WEBPVP8 ");
    maker.push("images", json!({ "bufferView": view, "mimeType": "image/webp", "name": "w" }));
    maker.push("textures", json!({ "source": 0 }));
    assert!(maker.warnings()[0].starts_with("image 0 (\"w\"): no texture: WebP pictures cannot be read"), "{:?}", maker.warnings());
    maker.json["textures"] = json!([{ "extensions": { "EXT_texture_webp": { "source": 0 } } }]);
    maker.json["extensionsUsed"] = json!(["EXT_texture_webp"]);
    assert_eq!(
        maker.warnings(),
        ["uses the extension EXT_texture_webp, which is not read", "material 0: texture 0 has no image that can be read"]
    );
}

#[test]
fn extensions_that_are_required_must_be_known() {
    let mut maker = Maker::triangle();
    maker.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression", "KHR_materials_unlit"]);
    assert_eq!(maker.warnings(), ["uses the extension KHR_draco_mesh_compression, which is not read"]);
    maker.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert!(maker.message().starts_with("requires the extension KHR_draco_mesh_compression, which cannot be read; export it without"));
    let mut maker = Maker::triangle();
    maker.json["asset"]["version"] = json!("1.0");
    assert!(maker.message().starts_with("is glTF 1.0; only glTF 2.0 can be read"));
}

#[test]
fn cameras_and_lights_hang_on_nodes() {
    let mut maker = Maker::triangle();
    maker.json["cameras"] = json!([
        { "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 }, "name": "eye" },
        { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 2.5, "zfar": 9, "znear": 1 } },
    ]);
    let light = |at: usize| json!({ "KHR_lights_punctual": { "light": at } });
    maker.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "directional", "intensity": 3, "color": [1, 0.5, 0] },
        { "type": "point" },
        { "type": "spot", "intensity": 7, "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.5 } },
    ] } });
    let up = 0.5_f64.sqrt();
    // Turned about x by 90 degrees: what looks along -z looks along +y.
    maker.json["nodes"] = json!([
        { "mesh": 0 },
        { "camera": 0, "translation": [1, 2, 3], "rotation": [up, 0, 0, up], "scale": [5, 5, 5], "extensions": light(0) },
        { "camera": 1, "name": "side", "extensions": light(1), "translation": [0, 0, 9] },
        { "camera": 0, "extensions": light(2), "translation": [0, 0, 9], "rotation": [up, 0, 0, up] },
    ]);
    maker.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let scene = maker.scene();
    assert_eq!(scene.cameras.iter().map(|camera| camera.name.as_str()).collect::<Vec<_>>(), ["eye", "side", "eye 2"]);
    assert!(!maker.animation().has_target(None), "a direction is no target");
    let camera = scene.camera(None).unwrap();
    assert_eq!(camera.eye, [1.0, 2.0, 3.0]);
    near(&[camera.target[0], camera.target[2]], &[1.0, 3.0], 1e-5);
    assert!(camera.target[1] > 2.5);
    near(&camera.up, &[0.0, 0.0, 1.0], 1e-6);
    near(&[camera.vertical_fov_degrees], &[57.295_78], 1e-4);
    assert_eq!(scene.camera(Some("side")).unwrap().orthographic_height, Some(5.0));
    let Light::Directional { direction, irradiance } = scene.lights[0] else { panic!("{:?}", scene.lights) };
    near(&direction, &[0.0, 1.0, 0.0], 1e-6);
    assert_eq!(irradiance, [3.0, 1.5, 0.0]);
    assert_eq!(scene.lights[1], Light::Point { position: [0.0, 0.0, 9.0], intensity: [1.0; 3] });
    let Light::Spot { intensity, inner_degrees, outer_degrees, .. } = scene.lights[2] else { panic!("{:?}", scene.lights) };
    assert_eq!(intensity, [7.0; 3]);
    near(&[inner_degrees, outer_degrees], &[5.729_578, 28.647_89], 1e-4);
    assert_eq!(scene.ambient, [0.0; 3], "a file with lights has no others");
}

#[test]
fn clips_by_name() {
    let mut maker = Maker::triangle();
    let sampler = json!({ "input": maker.floats(&[0.0, 2.0], "SCALAR"), "output": maker.floats(&[0.0, 0.0, 0.0, 8.0, 0.0, 0.0], "VEC3") });
    let slow = json!({ "input": maker.floats(&[0.0, 4.0], "SCALAR"), "output": maker.floats(&[0.0, 0.0, 0.0, 0.0, 8.0, 0.0], "VEC3") });
    let channel = json!([{ "sampler": 0, "target": { "node": 0, "path": "translation" } }]);
    maker.json["animations"] = json!([
        { "samplers": [sampler], "channels": channel, "name": "Walk" },
        { "samplers": [slow], "channels": channel },
        { "samplers": [sampler], "channels": channel, "name": "Walk" },
    ]);
    let first = maker.animation();
    let clips: Vec<(&str, f64)> = first.clips.iter().map(|clip| (clip.name.as_str(), clip.duration)).collect();
    assert_eq!(clips, [("Walk", 2.0), ("clip 1", 4.0), ("Walk 2", 2.0)]);
    assert_eq!((first.duration, first.cyclic, first.frame_count(24.0)), (2.0, true, 48));
    assert_eq!(maker.open(Some("clip 1")).unwrap().duration, 4.0);
    let message = maker.open(Some("wakl")).unwrap_err().to_string();
    assert_eq!(message, "there is no clip \"wakl\"; there are \"Walk\", \"clip 1\", \"Walk 2\"");
    let message = maker.open(Some("walk")).unwrap_err().to_string();
    assert!(message.ends_with("did you mean \"Walk\"?"), "{message}");
    let message = Maker::triangle().open(Some("walk")).unwrap_err().to_string();
    assert_eq!(message, "there is no clip \"walk\"; this scene has none: leave the clip out");
    assert!(matches!(first.motions[0], Motion::Deformed(_)));
    assert!(matches!(Maker::triangle().animation().motions[0], Motion::Still));
}

#[test]
fn animations_that_do_not_fit_are_named() {
    let case = |times: &[f32], values: &[f32], interpolation: &str| {
        let mut maker = Maker::triangle();
        maker.animate(0, "translation", interpolation, times, values);
        maker.message()
    };
    assert_eq!(
        case(&[0.0, 1.0], &[0.0; 3], "LINEAR"),
        "animation 0, channel 0: 2 times and 3 numbers do not fit together, or the times do not go up from 0; a key needs 3"
    );
    assert!(case(&[1.0, 0.0], &[0.0; 6], "LINEAR").contains("do not go up"));
    assert!(case(&[0.0, f32::NAN], &[0.0; 6], "LINEAR").contains("do not go up"));
    assert!(case(&[0.0, 1.0], &[0.0; 6], "CUBICSPLINE").contains("do not fit"));
    assert!(case(&[0.0, 1.0], &[0.0; 6], "BEZIER").contains("the interpolation is none of STEP, LINEAR, CUBICSPLINE"));

    // What points elsewhere than at a node is another extension's.
    let mut maker = Maker::triangle();
    maker.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let channels = maker.json["animations"][0]["channels"].as_array_mut().unwrap();
    channels.push(json!({ "sampler": 0, "target": { "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": "/x" } } } }));
    maker.json["extensionsUsed"] = json!(["KHR_animation_pointer"]);
    assert_eq!(maker.warnings(), ["uses the extension KHR_animation_pointer, which is not read"]);
    assert_eq!(maker.animation().duration, 1.0);
}

#[test]
fn broken_containers_are_told() {
    let good = Maker::triangle().glb();
    let case = |bytes: &[u8]| {
        let folder = folder(&[("a.glb", bytes)]);
        let message = open_in(&folder, None).unwrap_err().to_string();
        super::without_folder(&message, Path::new(folder.path()))
    };
    assert_eq!(
        case(&good[..good.len() - 40]),
        format!("DIR/a.glb: should have {} bytes and has {}; is the file cut off?", good.len(), good.len() - 40)
    );
    assert_eq!(case(b"glTF"), "DIR/a.glb: the file is cut off");
    let mut other = good.clone();
    other[4] = 1;
    assert_eq!(case(&other), "DIR/a.glb: is binary glTF 1; only version 2 can be read");
    let mut short = Maker::triangle();
    short.json["buffers"] = json!([{ "byteLength": 1000 }]);
    assert_eq!(
        case(&glb(&serde_json::to_vec(&short.json).unwrap(), &short.data)),
        "DIR/a.glb: buffer 0 should have 1000 bytes and has 96; is the file cut off?"
    );
    assert!(case(b"{ \"asset\": ").contains("cannot be read as glTF 2.0: EOF"));
}

#[test]
fn in_a_scene_file() {
    let mut maker = Maker::triangle();
    maker.push("nodes", json!({ "mesh": 0, "translation": [0, 0, 5] }));
    maker.json["scenes"][0]["nodes"] = json!([0, 1]);
    maker.animate(0, "translation", "LINEAR", &[0.0, 2.0], &[0.0, 0.0, 0.0, 8.0, 0.0, 0.0]);
    maker.json["animations"][0]["name"] = json!("go");
    let open_toml = |text: &str| {
        let folder = folder(&[("scene.toml", text.as_bytes()), ("sub/a.glb", &maker.glb())]);
        let opened = open(folder.path(), &LoadOptions::default(), &AnimationOptions::default());
        opened.map_err(|error| super::without_folder(&error.to_string(), folder.path()))
    };
    let place = |animation: &Animation, time: f64| {
        let Motion::Deformed(deformed) = &animation.motions[0] else { panic!("it moves") };
        let mut pose = gridwalk_scene::Pose::default();
        animation.pose(0, time, &mut pose);
        assert_eq!(deformed.positions, TRIANGLE);
        pose.matrices[0].map(|row| row[3])
    };
    let animation = open_toml(
        "[[mesh]]\nfile = \"sub/a.glb\"\nclip = \"go\"\nname = \"n\"\nscale = [-2, 2, 2]\ntranslate = [0, 1, 0]\nstart = 0.5\n\
         [[mesh]]\nshape = \"box\"\n",
    )
    .unwrap();
    let scene = &animation.scene;
    assert_eq!(scene.meshes.iter().map(|mesh| mesh.name.as_str()).collect::<Vec<_>>(), ["n/node 0", "n/node 1", "box"]);
    assert_eq!(scene.meshes[0].positions[1], [-6.0, 1.0, 0.0], "a quarter of the way, then placed");
    assert_eq!(scene.meshes[0].indices, [[0, 2, 1]]);
    assert_eq!(scene.meshes[1].positions[0], [0.0, 1.0, 10.0]);
    assert_eq!((animation.duration, animation.cyclic, animation.motions.len()), (2.0, true, 3));
    assert!(matches!(animation.motions[1], Motion::Still));
    assert_eq!([0.0, 1.5, 1.75, 2.0].map(|time| place(&animation, time)[0]), [-4.0, -16.0, -2.0, -4.0]);
    let once = open_toml("[[mesh]]\nfile = \"sub/a.glb\"\nloop = false\nstart = 0.5\n").unwrap();
    assert_eq!((once.duration, once.cyclic), (1.5, false));
    assert_eq!([0.0, 1.5, 9.0].map(|time| place(&once, time)[0]), [2.0, 8.0, 8.0]);

    assert_eq!(
        open_toml("[[mesh]]\nfile = \"sub/a.glb\"\nclip = \"gone\"\n").unwrap_err(),
        "DIR/scene.toml:3: there is no clip \"gone\"; there are \"go\""
    );
    assert_eq!(
        open_toml("[[mesh]]\nfile = \"sub/a.glb\"\nfps = 4\n").unwrap_err(),
        "DIR/scene.toml:1: a mesh of a glTF file has no fps; it moves as its clip says"
    );
    assert_eq!(open_toml("[[mesh]]\nshape = \"box\"\nclip = \"go\"\n").unwrap_err(), "DIR/scene.toml:1: clip belongs to a glTF file");
}

#[test]
fn from_a_stream() {
    let stream = gridwalk_scene::load_reader(&mut Maker::triangle().glb().as_slice(), None, &LoadOptions::default()).unwrap();
    assert_eq!(stream.meshes[0].positions, TRIANGLE);
    let mut outward = Maker::triangle();
    outward.json["buffers"] = json!([{ "byteLength": 1, "uri": "a.bin" }]);
    let bytes = glb(&serde_json::to_vec(&outward.json).unwrap(), &[]);
    let error = gridwalk_scene::load_reader(&mut bytes.as_slice(), None, &LoadOptions::default()).unwrap_err();
    assert!(error.to_string().starts_with("-: buffer 0: names the file \"a.bin\", but is a stream"), "{error}");
}
