//! QUIC datagrams by quinn-proto, driven by our own thread, with a congestion controller that never delays.

use std::{
    any::Any,
    fs,
    net::{SocketAddr, UdpSocket},
    path::Path,
    sync::Arc,
    time::Instant,
};

use bytes::{Bytes, BytesMut};
use quinn_proto::{
    ClientConfig, Connection, ConnectionHandle, DatagramEvent, Endpoint, EndpointConfig, Event, ServerConfig,
    TransportConfig,
    congestion::{Controller, ControllerFactory},
    crypto::rustls::QuicClientConfig,
};
use rustls::{
    RootCertStore,
    pki_types::{CertificateDer, PrivateKeyDer, PrivatePkcs8KeyDer},
};

use crate::{Engine, HERE, Outcome, PORT, THERE, now_ns};

const WINDOW: u64 = 1 << 24;

#[derive(Clone)]
struct Fixed;

impl Controller for Fixed {
    fn on_congestion_event(&mut self, _: Instant, _: Instant, _: bool, _: u64) {}
    fn on_mtu_update(&mut self, _: u16) {}
    fn window(&self) -> u64 {
        WINDOW
    }
    fn clone_box(&self) -> Box<dyn Controller> {
        Box::new(Self)
    }
    fn initial_window(&self) -> u64 {
        WINDOW
    }
    fn into_any(self: Box<Self>) -> Box<dyn Any> {
        self
    }
}

impl ControllerFactory for Fixed {
    fn build(self: Arc<Self>, _: Instant, _: u16) -> Box<dyn Controller> {
        Box::new(Self)
    }
}

pub(crate) fn prepare(folder: &Path) -> Outcome<()> {
    let made = rcgen::generate_simple_self_signed(["follower".to_owned()])?;
    fs::write(folder.join("certificate"), made.cert.der())?;
    Ok(fs::write(folder.join("key"), made.signing_key.serialize_der())?)
}

pub(crate) struct Quic {
    socket: UdpSocket,
    endpoint: Endpoint,
    connection: Option<(ConnectionHandle, Connection)>,
    is_connected: bool,
    out: Vec<u8>,
}

impl Quic {
    pub(crate) fn open(sends: bool, folder: &Path) -> Outcome<Self> {
        rustls::crypto::ring::default_provider().install_default().ok();
        let certificate = CertificateDer::from(fs::read(folder.join("certificate"))?);
        let mut transport = TransportConfig::default();
        transport.congestion_controller_factory(Arc::new(Fixed));
        let transport = Arc::new(transport);
        let socket = UdpSocket::bind((if sends { HERE } else { THERE }, PORT))?;
        socket.set_nonblocking(true)?;
        let common = Arc::new(EndpointConfig::default());
        let mut this = Self {
            socket,
            endpoint: Endpoint::new(Arc::clone(&common), None, true, None),
            connection: None,
            is_connected: false,
            out: Vec::with_capacity(4096),
        };
        if sends {
            let mut roots = RootCertStore::empty();
            roots.add(certificate)?;
            let tls = rustls::ClientConfig::builder().with_root_certificates(roots).with_no_client_auth();
            let mut client = ClientConfig::new(Arc::new(QuicClientConfig::try_from(tls)?));
            client.transport_config(transport);
            let to: SocketAddr = format!("{THERE}:{PORT}").parse()?;
            this.connection = Some(this.endpoint.connect(Instant::now(), client, to, "follower")?);
        } else {
            let key = PrivateKeyDer::Pkcs8(PrivatePkcs8KeyDer::from(fs::read(folder.join("key"))?));
            let mut server = ServerConfig::with_single_cert(vec![certificate], key)?;
            server.transport_config(transport);
            this.endpoint = Endpoint::new(common, Some(Arc::new(server)), true, None);
        }
        Ok(this)
    }

    fn flush(&mut self) {
        let Some((handle, connection)) = &mut self.connection else { return };
        let now = Instant::now();
        if connection.poll_timeout().is_some_and(|at| at <= now) {
            connection.handle_timeout(now);
        }
        while let Some(event) = connection.poll_endpoint_events() {
            if let Some(event) = self.endpoint.handle_event(*handle, event) {
                connection.handle_event(event);
            }
        }
        while let Some(event) = connection.poll() {
            self.is_connected |= matches!(event, Event::Connected);
        }
        self.out.clear();
        while let Some(transmit) = connection.poll_transmit(now, 1, &mut self.out) {
            self.socket.send_to(&self.out[..transmit.size], transmit.destination).ok();
            self.out.clear();
        }
    }
}

impl Engine for Quic {
    fn is_ready(&mut self) -> bool {
        self.is_connected
    }

    fn send(&mut self, payload: &[u8]) {
        if let Some((_, connection)) = &mut self.connection {
            connection.datagrams().send(Bytes::copy_from_slice(payload), true).ok();
        }
        self.flush();
    }

    fn poll(&mut self, got: &mut dyn FnMut(&[u8], u64)) {
        let mut buffer = [0; 2048];
        while let Ok((len, from)) = self.socket.recv_from(&mut buffer) {
            let now = Instant::now();
            let data = BytesMut::from(&buffer[..len]);
            self.out.clear();
            match self.endpoint.handle(now, from, None, None, data, &mut self.out) {
                Some(DatagramEvent::ConnectionEvent(_, event)) => {
                    if let Some((_, connection)) = &mut self.connection {
                        connection.handle_event(event);
                    }
                }
                Some(DatagramEvent::NewConnection(incoming)) => {
                    self.connection = self.endpoint.accept(incoming, now, &mut self.out, None).ok();
                }
                Some(DatagramEvent::Response(transmit)) => {
                    self.socket.send_to(&self.out[..transmit.size], transmit.destination).ok();
                }
                None => {}
            }
        }
        self.flush();
        if let Some((_, connection)) = &mut self.connection {
            while let Some(payload) = connection.datagrams().recv() {
                got(&payload, now_ns());
            }
        }
    }
}
