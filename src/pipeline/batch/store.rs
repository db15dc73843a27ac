//! Object storage: the only door to the crate `object_store`.
//!
//! Credentials and endpoints come from the environment, by the names that each provider's own tools use (`AWS_REGION`,
//! `AWS_ENDPOINT`, `GOOGLE_SERVICE_ACCOUNT`, `AZURE_STORAGE_ACCOUNT_NAME`, ...). An object appears as a whole or not at all.

#[cfg(feature = "object-storage")]
pub use with_crate::Store;
#[cfg(not(feature = "object-storage"))]
pub use without::Store;

#[cfg(feature = "object-storage")]
mod with_crate {
    use crate::error::{Error, Result};
    use object_store::path::Path;
    use object_store::{ObjectStore, ObjectStoreExt, parse_url_opts};
    use std::ffi::OsString;
    use std::fmt;
    use std::future::Future;
    use tokio::runtime::{Builder, Runtime};

    /// Objects whose names begin alike.
    pub struct Store {
        address: String,
        runtime: Runtime,
        objects: Box<dyn ObjectStore>,
        prefix: Path,
    }

    impl fmt::Debug for Store {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.debug_struct("Store").field("address", &self.address).finish_non_exhaustive()
        }
    }

    impl Store {
        /// The objects below an address: s3://bucket/night, gs://..., az://...
        ///
        /// # Errors
        /// Usage, if the address makes no sense or the environment lacks what it takes to reach it.
        pub fn open(address: &str) -> Result<Store> {
            let refuse = |what: String| {
                Error::usage(what).at(address).remedy("write s3://BUCKET/PREFIX, gs://... or az://..., see README.md")
            };
            let url = url::Url::parse(address).map_err(|e| refuse(format!("not an address: {e}")))?;
            let text = |(key, value): (OsString, OsString)| {
                Some((key.into_string().ok()?.to_lowercase(), value.into_string().ok()?))
            };
            let is_provider = |key: &str| ["aws_", "google_", "azure_"].iter().any(|start| key.starts_with(start));
            let settings = std::env::vars_os().filter_map(text).filter(|(key, _)| is_provider(key));
            let (objects, prefix) = parse_url_opts(&url, settings).map_err(|e| refuse(e.to_string()))?;
            // Calls come from several threads, each of which drives its own request to the end.
            let runtime = Builder::new_current_thread().enable_all().build();
            let runtime = runtime.map_err(|e| Error::bug(format!("no runtime for requests: {e}")))?;
            Ok(Store { address: address.to_owned(), runtime, objects, prefix })
        }

        /// The bytes of an object; none if it is not there.
        pub fn read(&self, name: &str) -> Result<Option<Vec<u8>>> {
            let path = self.path(name);
            let read = async { self.objects.get(&path).await?.bytes().await };
            match self.wait(read) {
                Ok(bytes) => Ok(Some(bytes.to_vec())),
                Err(object_store::Error::NotFound { .. }) => Ok(None),
                Err(e) => Err(self.failed(name, &e)),
            }
        }

        /// Writes an object, in place of an earlier one.
        pub fn write(&self, name: &str, bytes: Vec<u8>) -> Result<()> {
            let path = self.path(name);
            self.wait(self.objects.put(&path, bytes.into())).map(|_| ()).map_err(|e| self.failed(name, &e))
        }

        /// Removes an object.
        pub fn remove(&self, name: &str) -> Result<()> {
            let path = self.path(name);
            self.wait(self.objects.delete(&path)).map_err(|e| self.failed(name, &e))
        }

        /// The names of the objects right below a folder of the address (none: itself), in order.
        pub fn files(&self, folder: &str) -> Result<Vec<String>> {
            Ok(self.list(folder)?.0)
        }

        /// The names of the objects in and below a folder, from there on.
        pub fn files_below(&self, folder: &str) -> Result<Vec<String>> {
            let (mut names, folders) = self.list(folder)?;
            for inner in folders {
                let below = self.files_below(&format!("{folder}/{inner}"))?;
                names.extend(below.into_iter().map(|name| format!("{inner}/{name}")));
            }
            Ok(names)
        }

        /// The objects and the folders in a folder.
        fn list(&self, folder: &str) -> Result<(Vec<String>, Vec<String>)> {
            let path = self.path(folder);
            let listed =
                self.wait(self.objects.list_with_delimiter(Some(&path))).map_err(|e| self.failed(folder, &e))?;
            let name = |path: &Path| path.filename().map(str::to_owned);
            let mut names: Vec<String> = listed.objects.iter().filter_map(|object| name(&object.location)).collect();
            names.sort();
            Ok((names, listed.common_prefixes.iter().filter_map(name).collect()))
        }

        fn path(&self, name: &str) -> Path {
            name.split('/').filter(|part| !part.is_empty()).fold(self.prefix.clone(), |path, part| path.join(part))
        }

        fn wait<T>(&self, request: impl Future<Output = T>) -> T {
            self.runtime.block_on(request)
        }

        fn failed(&self, name: &str, error: &object_store::Error) -> Error {
            let what = error.to_string().replace(['\n', '\r'], " ");
            let place = format!("{}/{name}", self.address.trim_end_matches('/'));
            Error::input(what).file(place.as_ref()).remedy("check the address, the credentials and the network")
        }
    }
}

#[cfg(not(feature = "object-storage"))]
mod without {
    use crate::error::{Error, Result};

    /// No store: this build reaches none.
    #[derive(Debug)]
    pub enum Store {}

    impl Store {
        /// Refuses every address.
        pub fn open(address: &str) -> Result<Store> {
            Err(Error::usage("this build of homeo has no object storage")
                .at(address)
                .remedy("build it with cargo build --release --features object-storage, or name a folder"))
        }

        /// As there is no store, nothing is called on it.
        pub fn read(&self, _: &str) -> Result<Option<Vec<u8>>> {
            match *self {}
        }

        /// Likewise.
        pub fn write(&self, _: &str, _: Vec<u8>) -> Result<()> {
            match *self {}
        }

        /// Likewise.
        pub fn remove(&self, _: &str) -> Result<()> {
            match *self {}
        }

        /// Likewise.
        pub fn files(&self, _: &str) -> Result<Vec<String>> {
            match *self {}
        }

        /// Likewise.
        pub fn files_below(&self, _: &str) -> Result<Vec<String>> {
            match *self {}
        }
    }
}
