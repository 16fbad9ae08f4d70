use std::{
    net::{Ipv4Addr, UdpSocket},
    sync::mpsc::channel,
    thread::scope,
};

use super::{
    exchange::{ANSWER, ASK, COOKIE, Content, DONE, HELLO, PROVE, content},
    offer::Offer,
    *,
};
use crate::{
    impairment::{ImpairmentSettings, LossModel},
    relay::{Relay, RelaySettings},
};

const WAIT: Duration = Duration::from_secs(10);

/// Returns an address whose port was free a moment ago.
fn free_address() -> SocketAddr {
    UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap().local_addr().unwrap()
}

fn attempts() -> (tempfile::TempDir, Attempts) {
    let folder = tempfile::tempdir().unwrap();
    let attempts = Attempts::open(folder.path()).unwrap();
    (folder, attempts)
}

/// Runs both sides; the console reaches the follower through `reached`, and `enter` converts the code.
fn both(
    console: &NetworkKeys,
    follower: &NetworkKeys,
    at: SocketAddr,
    reached: SocketAddr,
    enter: impl Fn(Code) -> Code,
) -> [Result<PublicKey, PairingError>; 2] {
    let stop = AtomicBool::new(false);
    scope(|scope| {
        let (show, shown) = channel();
        let stop = &stop;
        let offer = Pairing { keys: follower, wait: WAIT, called_off: stop };
        let theirs = scope.spawn(move || offer.offer(at, |code| show.send(code).unwrap()));
        let (_folder, mut attempts) = attempts();
        let code = enter(shown.recv().unwrap());
        let ours = Pairing { keys: console, wait: WAIT, called_off: stop }.ask(reached, code, &mut attempts);
        if ours.is_err() {
            stop.store(true, Relaxed);
        }
        [ours, theirs.join().unwrap()]
    })
}

fn other(code: Code) -> Code {
    let mut digits = code.0;
    digits[3] = b'0' + (digits[3] - b'0' + 1) % 10;
    Code(digits)
}

#[test]
fn the_code_of_the_follower_gives_both_keys_and_another_one_none() {
    let [console, follower] = [(); 2].map(|()| NetworkKeys::random().unwrap());
    let at = free_address();
    let [ours, theirs] = both(&console, &follower, at, at, |code| Code::parse(&format!(" {code}\n")).unwrap());
    assert_eq!((ours.unwrap(), theirs.unwrap()), (follower.public(), console.public()));
    let at = free_address();
    let [ours, theirs] = both(&console, &follower, at, at, other);
    assert!(matches!(ours, Err(PairingError::WrongCode)) && matches!(theirs, Err(PairingError::Nobody)));
}

#[test]
fn a_code_has_nine_digits_and_differs_each_time() {
    let code = Code::random().unwrap();
    assert_eq!(code.to_string().len(), 11);
    assert_ne!(code, Code::random().unwrap());
    assert_eq!(Code::parse("012-345 678").unwrap().to_string(), "012 345 678");
    for wrong in ["", "012 345 67", "012 345 6789", "012 345 67a", "+12345678"] {
        assert!(matches!(Code::parse(wrong), Err(PairingError::NoCode)), "{wrong}");
    }
}

#[test]
fn lost_datagrams_are_sent_again() {
    let [console, follower] = [(); 2].map(|()| NetworkKeys::random().unwrap());
    let at = free_address();
    let bad = ImpairmentSettings { loss: LossModel::Independent { fraction: 0.3 }, ..ImpairmentSettings::default() };
    let home = (Ipv4Addr::LOCALHOST, 0).into();
    let relay = Relay::start(RelaySettings { at: home, to: at, there: bad, back: bad, seed: 4 }).unwrap();
    let [ours, theirs] = both(&console, &follower, at, relay.address(), |code| code);
    assert_eq!((ours.unwrap(), theirs.unwrap()), (follower.public(), console.public()));
}

#[test]
fn three_wrong_codes_make_a_pause_also_for_the_next_program() {
    let (folder, mut attempts) = attempts();
    for _ in 0..WRONG_MAX {
        attempts.may_begin().unwrap();
        attempts.count().unwrap();
    }
    let mut next = Attempts::open(folder.path()).unwrap();
    let report = next.may_begin().unwrap_err().to_string();
    assert!(report.contains("wait 60 s") || report.contains("wait 59 s"), "{report}");
    let stop = AtomicBool::new(false);
    let keys = NetworkKeys::random().unwrap();
    let pairing = Pairing { keys: &keys, wait: WAIT, called_off: &stop };
    let asked = pairing.ask(free_address(), Code::random().unwrap(), &mut next);
    assert!(matches!(asked, Err(PairingError::TooMany { .. })));
    let now_s = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_secs();
    let in_s = |seconds: i64| {
        Attempts::open(folder.path()).unwrap().may_begin_at(now_s.checked_add_signed(seconds).unwrap()).is_ok()
    };
    assert!(in_s(61) && in_s(-3600) && !in_s(30), "after a minute, and after a clock was set back");
}

/// A follower's side with a stranger who sends what it likes, without a network.
struct Stranger<'a> {
    offer: Offer<'a>,
    t_s: f64,
}

impl Stranger<'_> {
    fn sends(&mut self, token: u64, step: u8, content: &Content, from: SocketAddr) -> Option<(u8, Content, bool)> {
        let (answer, console) = self.offer.take((token, step, content), from, self.t_s).unwrap()?;
        let (number, step, content) = read(&answer).unwrap();
        assert_eq!(number, token);
        Some((step, *content, console.is_some()))
    }

    /// Runs the console's side with this code; returns whether the follower accepted it.
    fn pairs(&mut self, keys: &NetworkKeys, code: Code, from: SocketAddr) -> bool {
        let mut console = Console::new(code, keys.public());
        for _ in 0..3 {
            let (step, content) = console.question();
            let Some((step, content, _)) = self.sends(from.port().into(), step, &content, from) else { return false };
            match console.take(step, &content) {
                Step::Continues => {}
                Step::Done(_) => return true,
                Step::Waits | Step::Wrong => return false,
            }
        }
        false
    }
}

fn place(number: u8, port: u16) -> SocketAddr {
    (Ipv4Addr::new(10, 0, 0, number), port).into()
}

#[test]
fn strangers_neither_end_an_offer_nor_keep_the_console_out() {
    let [follower, console, stranger] = [(); 3].map(|()| NetworkKeys::random().unwrap());
    let mut there = Stranger { offer: Offer::new(&follower).unwrap(), t_s: 0.0 };
    let code = there.offer.code;
    // Without a cookie nothing is computed and nothing is kept, whatever the sender's address says.
    for number in 0..200 {
        assert!(there.sends(number, ASK, &content(&[&[7; 49]]), place(number as u8, 1)).is_none());
        assert!(there.sends(number, PROVE, &content(&[&[7; 64]]), place(number as u8, 1)).is_none());
    }
    assert_eq!(there.offer.guesses, 0);
    // With cookies, a stranger has a few guesses at once, and none of them ends the offer.
    let guesses = (0..40).filter(|&port| {
        there.pairs(&stranger, other(code), place(1, 1000 + port));
        there.offer.guesses > u32::from(port)
    });
    assert!(guesses.count() <= 4, "a guess is limited for each address");
    assert!(there.pairs(&console, code, place(2, 5)), "the console is let in, during the flood");
}

#[test]
fn an_offer_ends_after_a_thousand_guesses_and_never_changes_its_code() {
    let [follower, console] = [(); 2].map(|()| NetworkKeys::random().unwrap());
    let mut there = Stranger { offer: Offer::new(&follower).unwrap(), t_s: 0.0 };
    let code = there.offer.code;
    there.offer.guesses = GUESSES_MAX - 1;
    assert!(there.pairs(&console, code, place(1, 1)), "the last guess may be the right one");
    assert_eq!(there.offer.guesses, GUESSES_MAX);
    let from = place(1, 2);
    let (_, cookie, _) = there.sends(2, HELLO, &content(&[]), from).unwrap();
    let mut here = Console::new(code, console.public());
    assert!(matches!(here.take(COOKIE, &cookie), Step::Continues));
    let (step, asked) = here.question();
    let report = there.offer.take((2, step, &asked), from, there.t_s).err().unwrap().to_string();
    assert!(report.contains("1000 wrong codes") && report.contains("firewall"), "{report}");
    assert_eq!(there.offer.code, code);
}

#[test]
fn many_addresses_at_once_do_not_keep_the_console_out() {
    let [follower, console, stranger] = [(); 3].map(|()| NetworkKeys::random().unwrap());
    let mut there = Stranger { offer: Offer::new(&follower).unwrap(), t_s: 0.0 };
    let code = there.offer.code;
    for number in 1..=16 {
        there.pairs(&stranger, other(code), place(number, 1));
    }
    assert_eq!(there.offer.guesses, 16, "the maximum burst");
    let from = place(100, 5);
    for _ in 0..10 {
        assert!(!there.pairs(&console, code, from), "no exchange may begin now");
    }
    there.t_s = 0.15;
    assert!(there.pairs(&console, code, from), "the refusals must not count for the console's address");
}

#[test]
fn each_exchange_tests_one_guess_and_proves_both_keys() {
    let [follower, console] = [(); 2].map(|()| NetworkKeys::random().unwrap());
    let mut there = Stranger { offer: Offer::new(&follower).unwrap(), t_s: 0.0 };
    let from = place(1, 1);
    let mut here = Console::new(there.offer.code, console.public());
    let (_, cookie, _) = there.sends(1, HELLO, &content(&[]), from).unwrap();
    assert!(matches!(here.take(COOKIE, &cookie), Step::Continues));
    let (step, asked) = here.question();
    let (_, answer, _) = there.sends(1, step, &asked, from).unwrap();
    let again = there.sends(1, step, &asked, from).unwrap().1;
    assert_eq!((answer, there.offer.guesses), (again, 1), "a repeated request is the same guess");
    assert!(matches!(here.take(ANSWER, &answer), Step::Continues));
    let (step, proved) = here.question();
    // An attacker between the machines puts another key into the proof.
    let mut changed = proved;
    changed[0] ^= 1;
    assert!(there.sends(1, step, &changed, from).is_none());
    assert!(there.sends(1, step, &proved, place(2, 1)).is_none(), "from another address");
    let (step, end, done) = there.sends(1, step, &proved, from).unwrap();
    assert!(done && step == DONE);
    let mut changed = end;
    changed[0] ^= 1;
    assert!(matches!(here.take(DONE, &changed), Step::Waits));
    assert!(matches!(here.take(DONE, &end), Step::Done(key) if key == follower.public()));
    // The follower's key in the answer is protected in the same way.
    let mut here = Console::new(there.offer.code, console.public());
    here.take(COOKIE, &cookie);
    let (step, asked) = here.question();
    let (_, mut answer, _) = there
        .sends(2, HELLO, &content(&[]), from)
        .and_then(|(_, cookie, _)| there.sends(2, step, &content(&[&cookie[..16], &asked[16..49]]), from))
        .unwrap();
    answer[40] ^= 1;
    assert!(matches!(here.take(ANSWER, &answer), Step::Wrong));
}

#[test]
fn nobody_and_called_off_are_told() {
    let keys = NetworkKeys::random().unwrap();
    let stop = AtomicBool::new(false);
    let pairing = Pairing { keys: &keys, wait: Duration::from_millis(50), called_off: &stop };
    let asked = pairing.ask(free_address(), Code::random().unwrap(), &mut attempts().1);
    assert!(matches!(asked, Err(PairingError::Nobody)));
    stop.store(true, Relaxed);
    let offered = Pairing { keys: &keys, wait: WAIT, called_off: &stop }.offer(free_address(), |_| {});
    assert!(matches!(offered, Err(PairingError::Nobody)));
}

#[test]
fn random_bytes_are_no_pairing() {
    let mut rng = fastrand::Rng::with_seed(8);
    for _ in 0..5000 {
        let bytes: Vec<u8> = (0..rng.usize(..2 * LEN)).map(|_| rng.u8(..)).collect();
        assert!(read(&bytes).is_none());
    }
}
