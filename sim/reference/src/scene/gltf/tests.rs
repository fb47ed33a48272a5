//! Tests of the glTF reader, on files written here.

use super::super::HARMONIC_0;
use super::super::damage_tests::{assert_refused, rows, survives};
use super::*;
use base64::Engine;
use serde_json::{Value, json};

/// Two Gaussians: attributes behind the extension's name (but the first), their type, and floats one after the other.
const ATTRIBUTES: &str = "
    POSITION => VEC3 => 1 2 3 0 0 0
    ROTATION => VEC4 => 0 0 0 1 1 0 0 0
    SCALE => VEC3 => 0.5 1 2 1 1 1
    OPACITY => SCALAR => 0.25 1
    SH_DEGREE_0_COEF_0 => VEC3 => 1 0 -1 0 0 0
    SH_DEGREE_1_COEF_0 => VEC3 => 1 1 1 1 1 1
    SH_DEGREE_1_COEF_1 => VEC3 => 2 2 2 2 2 2
    SH_DEGREE_1_COEF_2 => VEC3 => 3 3 3 3 3 3
";

fn document() -> (Value, Vec<u8>) {
    let mut binary = Vec::new();
    let (mut views, mut accessors) = (Vec::new(), Vec::new());
    let mut attributes = serde_json::Map::new();
    for (index, [name, kind, values]) in rows(ATTRIBUTES).enumerate() {
        let values = values.split(' ').map(|value| value.parse().unwrap());
        let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
        views.push(json!({"buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len()}));
        accessors
            .push(json!({"bufferView": index, "componentType": 5126, "count": 2, "type": kind}));
        let own = format!("{EXTENSION}:{name}");
        attributes.insert(if index == 0 { name } else { own }, json!(index));
        binary.extend(bytes);
    }
    let document = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{
            "attributes": attributes,
            "mode": 0,
            "extensions": {EXTENSION: {"kernel": "ellipse", "sortingMethod": "zDepth"}}
        }]}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": binary.len()}],
    });
    (document, binary)
}

fn glb(document: &Value, binary: &[u8]) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + json.len() + 8 + binary.len();
    let word = |value: usize| (value as u32).to_le_bytes().to_vec();
    [
        b"glTF".to_vec(),
        word(2),
        word(total),
        word(json.len()),
        b"JSON".to_vec(),
        json,
        word(binary.len()),
        b"BIN\0".to_vec(),
        binary.to_vec(),
    ]
    .concat()
}

fn load_glb(bytes: &[u8]) -> Result<Scene, Problem> {
    load(bytes, None, "x")
}

fn changed(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let (mut document, binary) = document();
    change(&mut document);
    glb(&document, &binary)
}

#[test]
fn fields_are_decoded() {
    let scene = load_glb(&changed(|_| ())).unwrap();
    let splat = scene.splats[0];
    assert_eq!(splat.centre, [1.0, 2.0, 3.0]);
    assert_eq!(
        splat.axes,
        [[0.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]]
    );
    assert_eq!((splat.weight, scene.up), (0.25, [0.0, 1.0, 0.0]));
    assert!((splat.colour[0] - 0.5 - HARMONIC_0).abs() < 1e-12);
    let harmonics = scene.harmonics.unwrap();
    assert_eq!(harmonics.coefficients[..3], [[1.0; 3], [2.0; 3], [3.0; 3]]);
}

#[test]
fn the_same_buffer_may_be_a_data_uri_or_a_file() {
    let expected = load_glb(&changed(|_| ())).unwrap();
    let (mut document, binary) = document();
    let packed = base64::engine::general_purpose::STANDARD.encode(&binary);
    document["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{packed}"));
    assert_eq!(load_glb(document.to_string().as_bytes()).unwrap(), expected);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("x.bin"), &binary).unwrap();
    document["buffers"][0]["uri"] = json!("x.bin");
    let text = document.to_string();
    let found = load(text.as_bytes(), Some(folder.path()), "x").unwrap();
    assert_eq!(found, expected);
}

#[test]
fn nodes_move_turn_and_enlarge() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let scene = load_glb(&changed(|document| {
        document["nodes"] = json!([
            {"children": [1], "translation": [10, 0, 0]},
            {"mesh": 0, "rotation": [0, 0, half, half], "scale": [2, 2, 2]},
        ]);
    }))
    .unwrap();
    let splat = scene.splats[0];
    // A quarter turn around z takes x to y and y to -x.
    for (found, expected) in splat.centre.iter().zip([10.0 - 4.0, 2.0, 6.0]) {
        assert!((found - expected).abs() < 1e-12, "{:?}", splat.centre);
    }
    assert!((splat.axes[0][1] - 1.0).abs() < 1e-12);
    // Degree 1 in the trainers' order is (-y, z, -x): what was along -x (3) is along -y now.
    let first = scene.harmonics.unwrap().coefficients[0][0];
    assert!((f64::from(first) - 3.0).abs() < 1e-5, "{first}");
}

#[test]
fn integers_are_normalised() {
    let (mut document, mut binary) = document();
    let offset = binary.len();
    binary.extend([51, 255, 0, 0]);
    document["bufferViews"][3] = json!({"buffer": 0, "byteOffset": offset, "byteLength": 4});
    document["accessors"][3] = json!(
        {"bufferView": 3, "componentType": 5121, "normalized": true, "count": 2, "type": "SCALAR"}
    );
    document["buffers"][0]["byteLength"] = json!(binary.len());
    let scene = load_glb(&glb(&document, &binary)).unwrap();
    assert_eq!([scene.splats[0].weight, scene.splats[1].weight], [0.2, 1.0]);
}

#[test]
fn what_would_be_drawn_otherwise_is_refused_by_name() {
    for (field, value) in [
        ("kernel", "box"),
        ("projection", "orthographic"),
        ("colorSpace", "lin_rec709_display"),
        ("sortingMethod", "radix"),
    ] {
        let bytes = changed(|document| {
            document["meshes"][0]["primitives"][0]["extensions"][EXTENSION][field] = json!(value);
        });
        let error = load(&bytes, None, "x").unwrap_err().to_string();
        let named = error.contains(&format!("{EXTENSION}.{field}")) && error.contains(value);
        assert!(named && error.contains("export the scene with"), "{error}");
    }
}

/// The extension's own default is the distance.
#[test]
fn the_order_is_the_files() {
    let loaded = |change: &dyn Fn(&mut Value)| {
        load(&changed(|document| change(document)), None, "x").unwrap()
    };
    let stated = |method: &str| {
        let method = json!(method);
        loaded(&move |document| {
            document["meshes"][0]["primitives"][0]["extensions"][EXTENSION]["sortingMethod"] =
                method.clone();
        })
    };
    assert_eq!(stated("zDepth").order, SortOrder::Depth);
    assert_eq!(stated("cameraDistance").order, SortOrder::Distance);
    let silent = loaded(&|document| {
        let extension = &mut document["meshes"][0]["primitives"][0]["extensions"][EXTENSION];
        extension.as_object_mut().unwrap().remove("sortingMethod");
    });
    assert_eq!((silent.order, silent.notes.len()), (SortOrder::Distance, 0));
    let mixed = loaded(&|document| {
        let primitives = document["meshes"][0]["primitives"].as_array_mut().unwrap();
        let mut other = primitives[0].clone();
        other["extensions"][EXTENSION]["sortingMethod"] = json!("cameraDistance");
        primitives.push(other);
    });
    assert_eq!(mixed.order, SortOrder::Depth);
    assert!(
        mixed.notes[0].contains("all are drawn in order of depth"),
        "{:?}",
        mixed.notes
    );
}

#[test]
fn damaged_files_are_refused() {
    survives(&changed(|_| ()), &load_glb);
}

#[test]
fn each_message_names_the_field_and_the_fix() {
    let primitive = "/meshes/0/primitives/0";
    let kernel = format!("{primitive}/extensions/{EXTENSION}/kernel");
    let table = r#"
        KERNEL => "cube" => kernel: 'cube' is not read
        PRIMITIVE/extensions => {} => no primitive of the scene has the extension
        /accessors/0/count => 3 => accessor 0 (POSITION): 3 elements of 12 bytes do not fit
        /accessors/0/count => 18446744073709551615 => elements of 12 bytes do not fit its buffer view
        /accessors/3/count => 1 => accessor count: 1 beside 2 positions
        /accessors/0/type => "VEC2" => accessor 0 (POSITION): its type is 'VEC2'; VEC3 is needed
        /accessors/0/componentType => 5125 => its component type is 5125; floats
        /bufferViews/0/buffer => 7 => buffer 7: it is used but not there
        /buffers/0/byteLength => 9999 => buffer 0: 9999 bytes are needed but
        /nodes/0 => {"children": [0]} => nodes are nested too deeply or in a circle
        /scenes/0/nodes => [5] => node 5: it is used but not there
        /nodes/0 => {"mesh": 0, "scale": [1, 2, 1]} => node transform: it scales axes differently
    "#;
    let table = table
        .replace("KERNEL", &kernel)
        .replace("PRIMITIVE", primitive);
    for [pointer, value, expected] in rows(&table) {
        let value = serde_json::from_str(&value).unwrap();
        let bytes = changed(|document| *document.pointer_mut(&pointer).unwrap() = value);
        assert_refused(&[(bytes, &*expected)], load_glb);
    }
    let coefficient = format!("{EXTENSION}:SH_DEGREE_1_COEF_2");
    let cases = [
        (
            changed(|d| d["extensionsRequired"] = json!(["KHR_draco"])),
            "extensionsRequired: 'KHR_draco' is not read; export the scene with KHR_gaussian_splatting alone",
        ),
        (
            changed(|d| {
                let primitive = d.pointer_mut(primitive).unwrap();
                let attributes = primitive["attributes"].as_object_mut().unwrap();
                attributes.remove(&coefficient);
            }),
            "SH_DEGREE_1_COEF_2: the primitive lacks it; a degree must have all of its coefficients",
        ),
    ];
    assert_refused(&cases, load_glb);
}

/// A node that is the child of many: a short file must not become billions of meshes.
#[test]
fn shared_nodes_cannot_multiply_without_end() {
    let bytes = changed(|document| {
        let nodes: Vec<Value> = (0..40)
            .map(|k| json!({"children": [k + 1, k + 1]}))
            .collect();
        document["nodes"] = Value::Array([nodes, vec![json!({"mesh": 0})]].concat());
    });
    let message = load_glb(&bytes).unwrap_err().to_string();
    assert!(
        message.contains("nested too deeply or in a circle"),
        "{message}"
    );
}
