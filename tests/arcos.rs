use sidestep::arcos::*;
#[test]
fn quick() {
    let mut b = [0; MAX_FRAME];
    for (c, h) in [
        (HostCommand::velocity(250), "fa fb 06 0b 3b fa 00 05 3b"),
        (HostCommand::velocity(-100), "fa fb 06 0b 1b 64 00 6f 1b"),
        (
            HostCommand::wheel_velocities(10, 5),
            "fa fb 06 20 3b 05 0a 25 45",
        ),
    ] {
        let e: Vec<String> = c
            .encode(&mut b)
            .unwrap()
            .as_bytes()
            .iter()
            .map(|b| format!("{b:02x}"))
            .collect();
        assert_eq!(e.join(" "), h);
    }
    let cfg = "fa fb 79 20 50 69 6f 6e 65 65 72 00 70 33 64 78 00 53 49 4d 00 00 0f 27 0f 27 0f 27 0f 27 90 01 41 4d 52 49 53 69 6d 00 64 00 00 00 00 01 00 01 00 00 00 00 d0 07 00 00 00 00 00 00 00 00 00 96 00 b8 0b 64 00 64 00 00 00 00 00 00 00 2c 01 2c 01 00 00 00 00 00 00 00 00 00 00 02 00 00 00 00 00 00 00 00 00 53 2e 30 00 00 00 00 00 00 0f 27 0f 27 00 00 00 00 00 00 00 00 93 5f";
    let by: Vec<u8> = cfg
        .split(' ')
        .map(|x| u8::from_str_radix(x, 16).unwrap())
        .collect();
    let f = Frame::new_checked(&by).unwrap();
    let c = Configuration::decode(f).unwrap();
    println!("{c:?}");
    let e = c.encode(&mut b).unwrap();
    println!("{:x?}", e.as_bytes());
    assert_eq!(Configuration::decode(e).unwrap(), c);
}
