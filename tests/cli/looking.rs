//! `mtess render`: pictures of the size asked for, that show what was asked for.

use crate::kit::{Room, ball, ball_camera};
use mt_core::Camera;

/// Width, height and bytes of a PNG.
fn picture(room: &Room, name: &str) -> (u32, u32, Vec<u8>) {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(room.read(name))).read_info().expect("a PNG");
    let mut pixels = vec![0; decoder.output_buffer_size().expect("a size that memory takes")];
    let info = decoder.next_frame(&mut pixels).expect("whole pixels");
    (info.width, info.height, pixels)
}

fn render(room: &Room, options: &str) -> (u32, u32, Vec<u8>) {
    let told = room.good(&format!("render ball.mt {options} --painter cpu -o out.png"));
    assert!(told.out.contains("of 1280 triangles, drawn by the CPU painter"), "{}", told.out);
    picture(room, "out.png")
}

#[test]
fn pictures_have_the_size_asked_for() {
    let room = ball();
    room.write_camera("camera.json", &ball_camera());
    let size = |options: &str| {
        let (width, height, pixels) = render(&room, options);
        assert!(pixels.windows(8).any(|w| w[0] != w[4]), "{options}: one colour all over");
        (width, height)
    };
    assert_eq!(size("--error 0.02"), (1024, 768));
    assert_eq!(size("--error 0.02 --size 200x100"), (200, 100));
    assert_eq!(size("--camera camera.json"), (320, 240));
    assert_eq!(size("--camera camera.json --size 64x48"), (64, 48));
    assert_eq!(size("--camera camera.json --from-outside --size 160x120"), (160, 120));
    assert_eq!(size("--cells 100 --look-from camera.json"), (320, 240));
    let (width, height, _) = render(&room, "--reference --size 33x1");
    assert_eq!((width, height), (33, 1));
}

#[test]
fn overlays_and_viewpoints_show() {
    let room = ball();
    room.write_camera("camera.json", &ball_camera());
    let choices = [
        "",
        "--overlay wireframe",
        "--overlay error",
        "--overlay level",
        "--overlay wireframe --overlay level",
        "--from-outside",
        "--from-outside --overlay error --overlay wireframe",
        "--overlay normals",
        "--overlay outline",
    ];
    let pictures = choices.map(|choice| render(&room, &format!("--camera camera.json --size 120x90 {choice}")).2);
    for (i, one) in pictures.iter().enumerate() {
        for (j, other) in pictures.iter().enumerate().skip(i + 1) {
            assert!(one != other, "'{}' and '{}' look the same", choices[i], choices[j]);
        }
    }
    let again = render(&room, "--camera camera.json --size 120x90").2;
    assert!(again == pictures[0], "the same command, the same picture");
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let room = ball();
    room.refused("render ball.mt --error 0.1 -o out.jpg", "out.jpg");
    room.refused("render ball.mt --error 0.1 --overlay error --overlay level -o out.png", "error, level, normals");
    room.refused("render ball.mt --error 0.1 --overlay pieces -o out.png", "vertex hierarchy");
    room.refused("render ball.mt --error 0.1 --transparent -o out.svg", "--transparent");
    room.refused("render ball.mt --error 0.1 --caption no -o out.png", "--caption");
    room.refused("render ball.mt --error 0.1 -o nowhere/out.png", "nowhere");
    room.write_camera("bad.json", &Camera { near: 0.0, ..ball_camera() });
    room.refused("render ball.mt --error 0.1 --look-from bad.json -o out.png", "bad.json");
    room.refused("render ball.mt --camera bad.json -o out.png", "bad.json");
}

#[test]
fn drawings_have_lines_and_a_line_of_text() {
    let room = ball();
    room.write_camera("camera.json", &ball_camera());
    let told = room.good("render ball.mt --camera camera.json --pixels 2 -o out.svg");
    assert!(told.out.contains("of 1280 triangles, drawn in "), "{}", told.out);
    let svg = String::from_utf8(room.read("out.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("ball.mt, cells, 2 px on the screen: "), "{}", &svg[..400]);
    let more = room.good("render ball.mt --reference --overlay outline --caption (here) -o out.pdf");
    let pdf = String::from_utf8(room.read("out.pdf")).unwrap();
    assert!(pdf.starts_with("%PDF-1.4") && pdf.contains("(\\(here\\)) Tj"), "{more:?}");
}

#[test]
fn a_ground_can_be_left_out_and_pieces_be_shown() {
    let room = ball();
    room.good("build ball.ply -o pieces.mt --dependency dual-piece");
    room.good(
        "render pieces.mt --cells 60 --overlay pieces --transparent --finer 2 --size 64x48 --painter cpu -o out.png",
    );
    let (width, height, pixels) = picture(&room, "out.png");
    assert_eq!((width, height), (64, 48));
    let opacity = |x: usize, y: usize| pixels[4 * (y * 64 + x) + 3];
    assert_eq!((opacity(0, 0), opacity(32, 24)), (0, 255));
}

#[test]
fn movies_are_frames_and_one_file() {
    let room = ball();
    let told = room.good("movie ball.mt --frames 3 --pixels 4 --size 40x30 --wireframe --animation all.png -o frames");
    assert!(told.out.contains("frames: 3 frames"), "{}", told.out);
    for name in ["frames/0001.png", "frames/0003.png", "all.png"] {
        let (width, height, _) = picture(&room, name);
        assert_eq!((width, height), (40, 30), "{name}");
    }
    room.good("build ball.ply -o pieces.mt --dependency dual-piece");
    room.good("movie pieces.mt --frames 2 --size 20x10 --from-outside --boundary -o frames");
    room.refused("movie ball.mt --frames 2 --animation all.gif -o frames", "all.gif");
    room.refused("movie ball.mt --cameras nothing.json -o frames", "nothing.json");
}
