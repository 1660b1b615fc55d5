//! HEIDENHAIN iTNC 530 and TNC 640, Klartext.

mod reader;
mod straight;
