//! OpenEXR files: values and text survive, and the bytes depend on nothing else.

use exr::block::reader::ChunksReader;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Compression, FlatSamples, Image, Layer, LayerAttributes, SmallVec, Text,
    WritableImage, f16,
};
use homeo::ErrorKind;
use homeo::stage::exr::{BLOCK_ROWS, Compression as Squeeze, FloatImage, Format, Plane, encode, read, write_bands};
use std::io::{self, Cursor, Seek, SeekFrom, Write};

/// An image with no two equal values, and enough rows for several batches of blocks.
fn varied(width: usize, height: usize) -> FloatImage {
    let pixels: Vec<[f32; 3]> =
        (0..width * height).map(|i| [0, 1, 2].map(|axis| ((3 * i + axis) as f32 * 0.37).sin() * i as f32)).collect();
    FloatImage::rgb(width, height, &pixels)
}

/// The bit patterns of all values, so that NaN and -0 count.
fn bits(image: &FloatImage) -> Vec<(String, Vec<u32>)> {
    image.planes.iter().map(|p| (p.name.clone(), p.values.iter().map(|v| v.to_bits()).collect())).collect()
}

fn in_pool<T: Send>(threads: usize, job: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started").install(job)
}

#[test]
fn values_and_text_survive() {
    let mut image = varied(37, 53);
    image.planes[1].values[..6].copy_from_slice(&[
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        -0.0,
        f32::MIN_POSITIVE / 4.0,
        f32::MAX,
    ]);
    let json = r#"{"version":1,"text":"a \"quoted\" one"}"#;
    let (read_image, read_json) = read(Cursor::new(encode(&image, json).expect("a sound image"))).expect("our file");
    assert_eq!((read_image.width, read_image.height), (37, 53));
    assert_eq!(bits(&read_image), bits(&image));
    assert_eq!(read_json, json);
    let names: Vec<&str> = image.planes.iter().map(|plane| plane.name.as_str()).collect();
    assert_eq!(names, ["B", "G", "R"]);
}

#[test]
fn every_compression_keeps_every_bit_band_by_band() {
    let image = varied(70, 150);
    let rows = 2 * BLOCK_ROWS * 70;
    for compression in [Squeeze::None, Squeeze::Rle, Squeeze::Zip, Squeeze::Piz] {
        let format = Format { size: [70, 150], names: &["B", "G", "R"], compression };
        let mut bytes = Cursor::new(Vec::new());
        let bands = (0..70 * 150).step_by(rows).map(|first| first..(first + rows).min(70 * 150));
        let written = write_bands(format, "{}", &mut bytes, |sink| {
            let planes = |band: std::ops::Range<usize>| {
                image.planes.iter().map(|plane| &plane.values[band.clone()]).collect::<Vec<_>>()
            };
            bands.map(planes).try_for_each(|planes| sink(&planes))
        });
        written.expect("a sound image");
        let (read_image, _) = read(Cursor::new(bytes.into_inner())).expect("our file");
        assert_eq!(bits(&read_image), bits(&image), "{compression:?}");
    }
}

#[test]
fn one_pixel_and_one_channel_are_enough() {
    let image = FloatImage::grey(1, 1, vec![0.25]);
    let (read_image, json) = read(Cursor::new(encode(&image, "{}").expect("a sound image"))).expect("our file");
    assert_eq!((read_image, json.as_str()), (image, "{}"));
}

#[test]
fn bytes_do_not_depend_on_the_run_or_the_threads() {
    let image = varied(33, 2500);
    let once = in_pool(1, || encode(&image, "{\"a\":1}").expect("a sound image"));
    for threads in [1, 2, 3] {
        assert!(once == in_pool(threads, || encode(&image, "{\"a\":1}").expect("a sound image")), "{threads} threads");
    }
    assert_eq!(bits(&read(Cursor::new(once)).expect("our file").0), bits(&image));
}

#[test]
fn the_header_says_what_the_contract_says() {
    let bytes = encode(&varied(20, 40), "{}").expect("a sound image");
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), true).expect("a strict reader takes it");
    assert_eq!(meta.headers.len(), 1);
    let header = &meta.headers[0];
    assert_eq!(header.compression, Compression::ZIP16);
    assert_eq!(header.blocks, exr::meta::BlockDescription::ScanLines);
    assert_eq!(header.data_window(), header.shared_attributes.display_window);
    assert_eq!(header.shared_attributes.chromaticities, None);
    assert!(header.shared_attributes.other.is_empty());
    assert_eq!(header.own_attributes.other.len(), 1);
    let text = AttributeValue::Text(Text::from("{}"));
    assert_eq!(header.own_attributes.other.get(&b"homeo"[..]), Some(&text));
}

#[test]
fn row_zero_is_the_top() {
    let image = FloatImage::grey(2, 3, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let bytes = encode(&image, "{}").expect("a sound image");
    let chunks = exr::block::read(Cursor::new(bytes), true).expect("our file").all_chunks(true).expect("our chunks");
    let meta = chunks.meta_data().clone();
    let blocks: Vec<_> = chunks
        .map(|chunk| exr::block::UncompressedBlock::decompress_chunk(chunk.expect("whole"), &meta, true))
        .collect::<Result<_, _>>()
        .expect("our compression");
    let values: Vec<f32> = bytes_as_floats(&blocks[0].data);
    assert_eq!((blocks[0].index.pixel_position.1, values[0], values[5]), (0, 1.0, 6.0));
}

fn bytes_as_floats(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks::<4>().0.iter().map(|b| f32::from_ne_bytes(*b)).collect()
}

#[test]
fn images_that_contradict_themselves_are_not_written() {
    let plane = |name: &str, n: usize| Plane { name: name.to_string(), values: vec![0.0; n] };
    let image = |planes| FloatImage { width: 2, height: 2, planes };
    for planes in [
        vec![plane("Y", 3)],
        vec![plane("R", 4), plane("G", 4)],
        vec![plane("Y", 4), plane("Y", 4)],
        vec![plane("\u{1F980}", 4)],
        vec![],
    ] {
        assert_eq!(encode(&image(planes), "{}").expect_err("unsound").kind, ErrorKind::Bug);
    }
    assert!(encode(&FloatImage::grey(0, 0, Vec::new()), "{}").is_err());
    assert!(encode(&FloatImage::grey(1, 1, vec![0.0]), "\u{e4}").is_err());
}

#[test]
fn other_files_are_refused() {
    let layer = |attributes: LayerAttributes, samples: FlatSamples| {
        let channels = AnyChannels::sort(SmallVec::from_iter([AnyChannel::new("Y", samples)]));
        let image = Image::from_layer(Layer::new((1, 1), attributes, exr::image::Encoding::UNCOMPRESSED, channels));
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).expect("a sound image");
        read(Cursor::new(bytes.into_inner()))
    };
    let text = (Text::from("homeo"), AttributeValue::Text(Text::from("{}")));
    let with_text = || LayerAttributes { other: [text.clone()].into(), ..LayerAttributes::default() };
    assert!(layer(with_text(), FlatSamples::F32(vec![1.0])).is_ok());
    let halves = layer(with_text(), FlatSamples::F16(vec![f16::ONE])).expect_err("half floats");
    assert_eq!((halves.kind, halves.element.as_str()), (ErrorKind::Input, "channel Y"));
    let bare = layer(LayerAttributes::default(), FlatSamples::F32(vec![1.0])).expect_err("no text");
    assert!(bare.kind == ErrorKind::Input && bare.what.contains("homeo"), "{bare}");
    assert_eq!(read(Cursor::new(b"no image".to_vec())).expect_err("no image").kind, ErrorKind::Input);
}

#[test]
fn truncated_files_are_refused() {
    let bytes = encode(&varied(20, 40), "{}").expect("a sound image");
    for length in (0..bytes.len()).step_by(97) {
        let error = read(Cursor::new(bytes[..length].to_vec())).expect_err("truncated");
        assert_eq!(error.kind, ErrorKind::Input, "{length} bytes");
    }
}

/// A disk that is full after some bytes.
struct FullAfter(Cursor<Vec<u8>>, u64);

impl Write for FullAfter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.0.position() + bytes.len() as u64 > self.1 {
            return Err(io::Error::from(io::ErrorKind::StorageFull));
        }
        self.0.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for FullAfter {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

#[test]
fn a_full_disk_is_the_users_trouble_and_not_ours() {
    let image = varied(20, 40);
    for room in [0, 100, 600, 2000] {
        let error = homeo::stage::exr::write(&image, "{}", FullAfter(Cursor::new(Vec::new()), room));
        assert_eq!(error.expect_err("no room").kind, ErrorKind::Input, "{room} bytes");
    }
}
