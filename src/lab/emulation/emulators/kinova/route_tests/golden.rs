//! Requests and answers byte for byte, as Google's protobuf library writes the manufacturer's messages.

use std::io::Write as _;

use nima_devices::kinova::frame::{KinovaFrame, encode, encode_written, packed};
use nima_testing::real_time::judged;
use prost::Message as _;

use super::{Client, HOME_DEG, arm};
use crate::emulators::kinova::moves::ActionReport;

/// Call, request and answer: session 1, messages from 2 on.
const EXCHANGES: [(&str, &str, &str); 31] = [
    (
        "ReadAllDevices",
        "0a0f0d0000001115020001001d01001710",
        "0a140d0000001315020001001d01001710254400000012440a0208010a060803100118010a060803100218020a060803\
        100318030a060803100418040a060804100518050a060804100618060a060804100718070a06080510081808",
    ),
    (
        "GetDeviceType of actuator 5",
        "0a0f0d0000051115030001001d03000910",
        "0a140d0000051315030001001d03000910250200000012020804",
    ),
    (
        "GetSerialNumber of actuator 7",
        "0a0f0d0000071115040001001d08000910",
        "0a140d0000071315040001001d08000910250e000000120e0a0c454d554c415445442d312d37",
    ),
    (
        "GetMACAddress of the interconnect",
        "0a0f0d0000081115050001001d09000910",
        "0a140d0000081315050001001d09000910250800000012080a06020000000008",
    ),
    (
        "GetControlMode of actuator 3",
        "0a0f0d0000031115060001001d06000a10",
        "0a140d0000031315060001001d06000a10250200000012020801",
    ),
    (
        "SetControlMode of actuator 1",
        "0a140d0000011115070001001d07000a10250200000012020803",
        "0a0f0d0000011315070001001d07000a10",
    ),
    (
        "GetControlMode of actuator 1",
        "0a0f0d0000011115080001001d06000a10",
        "0a140d0000011315080001001d06000a10250200000012020803",
    ),
    ("GetAxisOffsets of actuator 2", "0a0f0d0000021115090001001d01000a10", "0a0f0d0000021315090001001d01000a10"),
    (
        "GetActivatedControlLoop of actuator 4",
        "0a0f0d00000411150a0001001d08000a10",
        "0a140d00000413150a0001001d08000a10250500000012050d2b000000",
    ),
    (
        "GetServoing of actuator 4",
        "0a0f0d00000411150b0001001d1d000a10",
        "0a140d00000413150b0001001d1d000a10250200000012020801",
    ),
    (
        "GetGravityVector",
        "0a0f0d00000011150c0001001d02001010",
        "0a140d00000013150c0001001d02001010250500000012051dc3f51cc1",
    ),
    (
        "SetPayloadInformation",
        "0a140d00000011150d0001001d03001010250c000000120c0d0000003f12051d8fc2f53c",
        "0a0f0d00000013150d0001001d03001010",
    ),
    (
        "GetPayloadInformation",
        "0a0f0d00000011150e0001001d04001010",
        "0a140d00000013150e0001001d04001010250c000000120c0d0000003f12051d8fc2f53c",
    ),
    (
        "SetToolConfiguration",
        "0a140d00000011150f0001001d05001010251800000012180a0a1dcdcccc3d2d0000b442150000803e1a050d0ad7233c",
        "0a0f0d00000013150f0001001d05001010",
    ),
    (
        "GetToolConfiguration",
        "0a0f0d0000001115100001001d06001010",
        "0a140d0000001315100001001d06001010251800000012180a0a1dcdcccc3d2d0000b442150000803e1a050d0ad7233c",
    ),
    (
        "SetTwistLinearSoftLimit",
        "0a140d0000001115110001001d0f001010250700000012070805150000803e",
        "0a0f0d0000001315110001001d0f001010",
    ),
    (
        "SetJointSpeedSoftLimits",
        "0a140d0000001115120001001d0e001010252000000012200801121c0000f0410000f0410000f0410000f0410000f041\
        0000f0410000f041",
        "0a0f0d0000001315120001001d0e001010",
    ),
    (
        "SetCartesianReferenceFrame",
        "0a140d0000001115130001001d09001010250200000012020802",
        "0a0f0d0000001315130001001d09001010",
    ),
    (
        "SetGPIOConfiguration",
        "0a140d0000081115140001001d06000e10250800000012080801100218012001",
        "0a0f0d0000081315140001001d06000e10",
    ),
    ("SetGPIOState", "0a140d0000081115150001001d08000e102504000000120408011002", "0a0f0d0000081315150001001d08000e10"),
    (
        "GetGPIOState",
        "0a140d0000081115160001001d07000e10250200000012020801",
        "0a140d0000081315160001001d07000e102504000000120408011002",
    ),
    (
        "GetProductConfiguration",
        "0a0f0d0000001115170001001dc6000210",
        "0a140d0000001315170001001dc6000210251a000000121a0a0a454d554c415445442d31100130073802400148015002\
        6002",
    ),
    (
        "CreateUserProfile",
        "0a140d0000001115180001001d01000210251600000012160a0f12056a636173681a064a6f686e6e791203707764",
        "0a140d0000001315180001001d010002102507000000120708011507000000",
    ),
    (
        "OnNotificationActionTopic",
        "0a0f0d0000001115190001001d6a000210",
        "0a140d0000001315190001001d6a000210250200000012020801",
    ),
    (
        "ReadActions of one kind",
        "0a140d00000011151a0001001d2c000210250200000012020801",
        "0a0f0d00000013151a0001001d2c000210",
    ),
    (
        "an unknown device",
        "0a0f0d00000c11151b0001001d03000910",
        "0a140d32300c13151b0001001d0300091025210000001221080310321a1b74686520646576696365206973206e6f7420\
        636f6e6e6563746564",
    ),
    (
        "ActuatorConfig of the base",
        "0a0f0d00000011151c0001001d06000a10",
        "0a140d04100013151c0001001d06000a1025150000001215080110041a0f756e6b6e6f776e2073657276696365",
    ),
    (
        "an unknown function of an actuator",
        "0a0f0d00000211151d0001001d63000a10",
        "0a140d05100213151d0001001d63000a1025160000001216080110051a10756e6b6e6f776e2066756e6374696f6e",
    ),
    (
        "VisionConfig",
        "0a0f0d00000011151e0001001d08000510",
        "0a140d04100013151e0001001d0800051025150000001215080110041a0f756e6b6e6f776e2073657276696365",
    ),
    (
        "CreateUserProfile without a name",
        "0a0f0d00000011151f0001001d01000210",
        "0a140d69300013151f0001001d0100021025190000001219080310691a13612075736572206e656564732061206e616d\
        65",
    ),
    (
        "Unsubscribe of nothing",
        "0a140d0000001115200001001d61000210250200000012020809",
        "0a140d1130001315200001001d6100021025140000001214080310111a0e6e6f207375636820656e74697479",
    ),
];
/// `ExecuteActionFromReference` of `Home`, its answer, and the notification of its start to subscription 1.
const HOME: [&str; 3] = [
    "0a140d0000001115210001001d2f00021025090000001209080210071d01000000",
    "0a0f0d0000001315210001001d2f000210",
    "0a140d0000001515010001001d6a000210250d000000120d08041209080210071d01000000",
];

fn bytes(hex: &str) -> Vec<u8> {
    hex.as_bytes().chunks(2).map(|two| u8::from_str_radix(std::str::from_utf8(two).unwrap(), 16).unwrap()).collect()
}

#[test]
fn requests_of_the_device_route_are_answered_byte_for_byte() {
    judged(|| {
        let serving = arm(HOME_DEG);
        let mut client = Client::connect(&serving);
        assert_eq!(client.session, 1);
        let exchange = |client: &mut Client, name: &str, request: &str, answer: &str| {
            let mut out = Vec::new();
            packed(&mut out, |out| out.extend(bytes(request)));
            client.stream.write_all(&out).unwrap();
            let (header, payload) = client.answer();
            let mut report = Vec::new();
            encode_written(&header, &payload, &mut report);
            assert_eq!(report, bytes(answer), "{name}: {header:?}");
            // The other direction: this crate writes the same request.
            let whole = bytes(request);
            let frame = KinovaFrame::decode(&whole).unwrap();
            let mut written = Vec::new();
            encode_written(&frame.header, frame.payload, &mut written);
            assert_eq!(written, whole, "{name}");
        };
        for (name, request, answer) in EXCHANGES {
            exchange(&mut client, name, request, answer);
        }
        exchange(&mut client, "ExecuteActionFromReference", HOME[0], HOME[1]);
        let (header, payload) = client.frame();
        let report = ActionReport::decode(payload.as_slice()).unwrap();
        let mut written = Vec::new();
        encode(&header, &report, &mut written);
        assert_eq!(written, bytes(HOME[2]), "{report:?}");
    });
}
